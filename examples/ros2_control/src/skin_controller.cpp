#include "skin_controller.hpp"

#include <pluginlib/class_list_macros.hpp>
#include <utility>

#include "scene.hpp"

namespace skinctl_controller {

using namespace skinctl;
using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;
using controller_interface::return_type;

namespace {
SkinSource& source_of_all() {
  static SkinSource source;
  return source;
}
InterfaceConfiguration individual(std::initializer_list<const char*> quantities) {
  InterfaceConfiguration out{controller_interface::interface_configuration_type::INDIVIDUAL, {}};
  for (const char* quantity : quantities)
    for (const char* joint : joint_names) out.names.push_back(std::string(joint) + '/' + quantity);
  return out;
}
}  // namespace

void set_skin_source(SkinSource source) {
  source_of_all() = std::move(source);
}

struct SkinController::Parts {
  decltype(make_scene()) scene = make_scene();
  typename decltype(make_scene())::Memory memory{};
  SkinSource skin = source_of_all();
  bool started = false;
};

SkinController::SkinController() = default;
SkinController::~SkinController() = default;

CallbackReturn SkinController::on_init() {
  parts_ = std::make_unique<Parts>();
  return CallbackReturn::SUCCESS;
}
InterfaceConfiguration SkinController::command_interface_configuration() const {
  return individual({"position"});
}
InterfaceConfiguration SkinController::state_interface_configuration() const {
  return individual({"position", "velocity"});
}
CallbackReturn SkinController::on_activate(const rclcpp_lifecycle::State&) {
  parts_->started = false;
  return command_interfaces_.size() == 6 && state_interfaces_.size() == 12 ? CallbackReturn::SUCCESS
                                                                           : CallbackReturn::ERROR;
}

// The first update starts the scene where the arm is; as in `run_loop`, commands begin with the next state.
// No allocation, lock or exception, if the skin's source has none.
return_type SkinController::update(const rclcpp::Time& time, const rclcpp::Duration&) {
  Parts& p = *parts_;
  State<6> measured;
  measured.time = Nanoseconds(time.nanoseconds());
  for (std::size_t i = 0; i < 6; ++i) {
    measured.q[i] = state_interfaces_[i].get_value();
    measured.dq[i] = state_interfaces_[6 + i].get_value();
  }
  const auto samples = p.skin ? p.skin(measured.time) : std::span<const CellSample>();
  if (!p.started) {
    p.scene.start(p.memory, measured);
    p.started = true;
    return return_type::OK;
  }
  decltype(p.scene)::Input input;
  input.now = measured.time;
  input.measured = measured;
  input.samples = samples;
  const auto out = p.scene.step(p.memory, input);
  if (!out.command.valid) return return_type::ERROR;
  for (std::size_t i = 0; i < 6; ++i)
    static_cast<void>(command_interfaces_[i].set_value(out.command.position[i]));
  return return_type::OK;
}

}  // namespace skinctl_controller

PLUGINLIB_EXPORT_CLASS(skinctl_controller::SkinController, controller_interface::ControllerInterface)
