// A controller of ros2_control: a UR5 by position that gives way to its skin, one cycle of skinctl in each
// `update()`.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "controller_interface/controller_interface.hpp"
#include "skinctl/sensing/cell_sample.hpp"

namespace skinctl_controller {

/// Where the samples of a cycle come from, stamped on the clock of `update()`, which shows `now`.
using SkinSource = std::function<std::span<const skinctl::CellSample>(skinctl::Nanoseconds now)>;
/// The source of controllers that are made from now on. A manager makes controllers by name and cannot pass
/// one: the library that knows the skin (a driver, `adapters::dds::SkinReader`) sets it when it is loaded.
void set_skin_source(SkinSource source);

class SkinController : public controller_interface::ControllerInterface {
 public:
  SkinController();
  ~SkinController() override;

  controller_interface::CallbackReturn on_init() override;
  [[nodiscard]] controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  [[nodiscard]] controller_interface::InterfaceConfiguration state_interface_configuration() const override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State&) override;
  controller_interface::return_type update(const rclcpp::Time& time, const rclcpp::Duration& period) override;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace skinctl_controller
