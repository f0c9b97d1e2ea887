// The consumer that streams a run to a live view.
#pragma once

#include <atomic>

#include "examples/adapters/live/contact_picture.hpp"
#include "examples/adapters/live/foxglove_server.hpp"
#include "skinctl/io/cycle_messages.hpp"
#include "skinctl/io/cycle_thread.hpp"
#include "skinctl/io/detail/pace.hpp"

namespace adapters::live {

/// What people ask for at a live view; the loop takes it into its next cycle.
class Requests {
 public:
  void ask(skinctl::CycleRequest request) noexcept { asked_.store(request); }
  /// The request since the last call, if any.
  [[nodiscard]] skinctl::CycleRequest take() noexcept { return asked_.exchange(skinctl::CycleRequest::none); }

 private:
  std::atomic<skinctl::CycleRequest> asked_{skinctl::CycleRequest::none};
};

/// Streams cycles to a server: joint states and torque shares of every cycle, cells, contacts and frames at 30 Hz, the
/// status at 10 Hz, robot and skin once. What nobody hears is not encoded.
template <class C>
class LiveView : public skinctl::CycleConsumer<C> {
 public:
  using typename skinctl::CycleConsumer<C>::Beginning;

  /// Adds topics and the services /skinctl/stop and /skinctl/resume to the server, which is started afterwards. Stop is
  /// always obeyed; resume where the server allows control. Throws where `CycleMessages` does.
  /// @param contacts  finds what presses; none: there is no skin. It stays the caller's.
  LiveView(FoxgloveServer& server, Requests& requests, skinctl::RunDescription run,
           ContactPicture* contacts = nullptr)
      : server_(server), messages_(std::move(run)), picture_(contacts) {
    using namespace skinctl;
    const auto topic = [&](const char* name, const MessageType& type, bool latched = false) {
      return server_.add(Channel{name, "cdr", type.name, type.schema, "ros2msg", latched});
    };
    joints_ = topic("/joint_states", ros::JointState::type());
    shares_ = topic("/skinctl/torque_shares", ros::Matrix::type());
    status_ = topic("/skinctl/status", ros::String::type());
    cells_ = topic("/skin/cells", SkinCloud::type());
    contacts_ = topic("/skin/contacts", ros::PointCloud::type());
    tf_ = topic("/tf", ros::Transforms::type());
    robot_ = topic("/robot_description", ros::String::type(), true);
    layout_ = topic("/skin/layout", ros::String::type(), true);
    server_.add(Service{"/skinctl/stop", false, [&requests] {
                          requests.ask(CycleRequest::stop);
                          return Answer{true, "the robot brakes, and holds"};
                        }});
    server_.add(Service{"/skinctl/resume", true, [&requests] {
                          requests.ask(CycleRequest::resume);
                          return Answer{true, "the robot goes on"};
                        }});
  }

  void start(const Beginning& begin, std::span<const unsigned char>) override {
    const auto latched = [&](std::uint32_t channel, const std::string& text) {
      if (!text.empty())
        server_.publish(channel, begin.measured.time, messages_.encoded(skinctl::ros::String{text}));
    };
    latched(robot_, messages_.run().urdf);
    latched(layout_, messages_.run().layout);
  }
  void cycle(const skinctl::CycleRecord<C>& r) override {
    using namespace skinctl;
    const Nanoseconds now = r.input.now;
    messages_.take(r);
    if (picture_ != nullptr)
      for (const CellSample& s : r.input.samples) picture_->take(s);
    since_ |= r.status;
    if (server_.wanted(joints_)) server_.publish(joints_, now, messages_.joint_states(r));
    if (server_.wanted(shares_)) server_.publish(shares_, now, messages_.torque_shares(r));
    if (drawn_.due(now)) {
      if (server_.wanted(tf_)) server_.publish(tf_, now, messages_.tf(r));
      if (server_.wanted(cells_)) server_.publish(cells_, now, messages_.cells(r));
      if (picture_ != nullptr && server_.wanted(contacts_)) {
        const auto found = picture_->find(now, messages_.places(r));
        server_.publish(contacts_, now, messages_.encoded(contact_cloud(now, messages_.run().base, found)));
      }
    }
    if (said_.due(now)) {
      if (server_.wanted(status_)) server_.publish(status_, now, messages_.status(r, since_, dropped_));
      since_ = {};
    }
  }
  void pause(std::uint64_t dropped) override { dropped_ = dropped; }

 private:
  FoxgloveServer& server_;
  skinctl::CycleMessages<C> messages_;
  ContactPicture* picture_ = nullptr;
  std::uint32_t joints_ = 0, shares_ = 0, status_ = 0, cells_ = 0, contacts_ = 0, tf_ = 0, robot_ = 0,
                layout_ = 0;
  skinctl::detail::Pace drawn_{std::chrono::milliseconds(33)}, said_{std::chrono::milliseconds(100)};
  skinctl::Status since_;
  std::uint64_t dropped_ = 0;
};

}  // namespace adapters::live
