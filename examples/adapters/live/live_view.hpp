// The consumer that streams a run to a live view.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <span>
#include <string>
#include <vector>

#include "examples/adapters/live/felt_map.hpp"
#include "examples/adapters/live/foxglove_server.hpp"
#include "skinctl/fusion/detail/blend_goal.hpp"
#include "skinctl/recording/cycle_messages.hpp"
#include "skinctl/recording/cycle_thread.hpp"
#include "skinctl/recording/detail/pace.hpp"

namespace adapters::live {

/// What people ask for at a live view; the loop takes it into its next cycle. No call waits.
class Requests {
 public:
  static constexpr std::size_t most_weights = 16;

  Requests() noexcept {
    for (auto& w : weights_) w.store(1);
  }
  void ask(skinctl::CycleRequest request) noexcept { asked_.store(request); }
  /// The request since the last call, if any.
  [[nodiscard]] skinctl::CycleRequest take() noexcept { return asked_.exchange(skinctl::CycleRequest::none); }

  /// The `law`-th weight of a blended sum shall be `weight`; the others stay as they are asked for, at
  /// first 1.
  void weigh(std::size_t law, double weight) noexcept {
    weights_[law].store(weight);
    weighed_.store(true);
  }
  /// Without asking for a change: the weights that the law has.
  void weigh_as(std::span<const double> weights) noexcept {
    for (std::size_t k = 0; k < weights.size(); ++k) weights_[k].store(weights[k]);
  }
  /// Writes all weights, if one was asked for since the last call.
  template <std::size_t Laws>
  [[nodiscard]] bool take(std::array<double, Laws>& weights) noexcept {
    static_assert(Laws <= most_weights);
    if (!weighed_.exchange(false)) return false;
    for (std::size_t k = 0; k < Laws; ++k) weights[k] = weights_[k].load();
    return true;
  }

 private:
  std::atomic<skinctl::CycleRequest> asked_{skinctl::CycleRequest::none};
  std::array<std::atomic<double>, most_weights> weights_{};
  std::atomic<bool> weighed_{false};
};

/// The weights that a goal of a blended law asks for; null: none.
template <std::size_t N>
const std::array<double, N>* weights_in(const skinctl::BlendWeights<N>& goal) noexcept {
  return &goal.of;
}
template <class G, std::size_t N>
const std::array<double, N>* weights_in(const skinctl::BlendGoal<G, N>& goal) noexcept {
  return goal.weights ? &goal.weights->of : nullptr;
}
template <class Goal>
concept AsksForWeights = requires(const Goal& goal) { weights_in(goal); };

/// The weight of a law, for a slider; lower = upper: there is none.
struct WeightRange {
  double first = 1;  ///< at the start
  double lower = 0, upper = 1;
};

/// Streams cycles to a server: joint states and torque shares of every cycle, cells, contacts and frames at
/// 30 Hz, the status at 10 Hz, how well each place feels once a second, robot and skin once. What nobody
/// hears is not encoded, but for those that a new listener is sent at once.
///
/// Where the scene's law is blended, its weights are parameters of the server, "weight of LAW". A weight that
/// the scene refuses goes back to what it was.
template <class C>
class LiveView : public skinctl::CycleConsumer<C> {
 public:
  using typename skinctl::CycleConsumer<C>::Beginning;

  /// Adds topics and the services /skinctl/stop and /skinctl/resume to the server, which is started
  /// afterwards. Stop is always obeyed; resume where the server allows control. Throws where `CycleMessages`
  /// does.
  /// @param weights  of a blended law, in its order.
  /// @param felt  what the loop writes of its skin, which lives longer; null: no topic /skin/felt.
  LiveView(FoxgloveServer& server, Requests& requests, skinctl::RunDescription run,
           const std::vector<WeightRange>& weights = {}, const FeltMap* felt = nullptr)
      : server_(server), messages_(std::move(run)), felt_(felt) {
    using namespace skinctl;
    const auto topic = [&](const char* name, const MessageType& type, bool latched = false) {
      return server_.add(Channel{name, "cdr", type.name, type.schema, "ros2msg", latched});
    };
    joints_ = topic("/joint_states", ros::JointState::type());
    shares_ = topic("/skinctl/torque_shares", ros::Matrix::type());
    status_ = topic("/skinctl/status", ros::String::type());
    cells_ = topic("/skin/cells", SkinCloud::type());
    contacts_ = topic("/skin/contacts", ros::PointCloud::type());
    if (felt_ != nullptr) felt_topic_ = topic("/skin/felt", ros::String::type(), true);
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
    if constexpr (AsksForWeights<typename C::Goal>) {
      weights_.resize(std::min(weights.size(), messages_.run().laws.size()));
      for (std::size_t k = 0; k < weights_.size(); ++k) {
        weights_[k] = weights[k].first;
        if (!(weights[k].lower < weights[k].upper)) continue;
        server_.add(Parameter{weight_name(k), weights[k].first, weights[k].lower, weights[k].upper,
                              [&requests, k](double w) { requests.weigh(k, w); }});
      }
      requests.weigh_as(weights_);
      requests_ = &requests;
    }
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
    since_ |= r.status;
    if constexpr (AsksForWeights<typename C::Goal>) {
      if (const auto* asked = r.input.goal ? weights_in(*r.input.goal) : nullptr)
        weighed(*asked, r.status.has(Reason::goal_refused));
    }
    const auto send = [&](std::uint32_t channel, auto&& message) {
      if (!server_.wanted(channel)) return;
      if (const auto bytes = message(); !bytes.empty()) server_.publish(channel, now, bytes);
    };
    if (plotted_.due(now)) {
      send(joints_, [&] { return messages_.joint_states(r); });
      send(shares_, [&] { return messages_.torque_shares(r); });
    }
    if (drawn_.due(now)) {
      send(tf_, [&] { return messages_.tf(r); });
      send(cells_, [&] { return messages_.cells(r); });
      send(contacts_, [&] { return messages_.contacts(r); });
    }
    if (felt_ != nullptr && felt_->whole() && mapped_.due(now))
      server_.publish(felt_topic_, now, messages_.encoded(ros::String{felt_->text()}));
    if (said_.due(now)) {
      if (server_.wanted(status_)) server_.publish(status_, now, messages_.status(r, since_, dropped_));
      since_ = {};
    }
  }
  void pause(std::uint64_t dropped) override { dropped_ = dropped; }

 private:
  [[nodiscard]] std::string weight_name(std::size_t k) const {
    return "weight of " + messages_.run().laws[k];
  }
  void weighed(std::span<const double> asked, bool refused) {
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (refused) {
        server_.set_parameter(weight_name(k), weights_[k]);
      } else {
        weights_[k] = asked[k];
      }
    }
    if (refused) requests_->weigh_as(weights_);
  }

  FoxgloveServer& server_;
  skinctl::CycleMessages<C> messages_;
  const FeltMap* felt_;
  std::vector<double> weights_;  // those that the scene took last
  Requests* requests_ = nullptr;
  std::uint32_t joints_ = 0, shares_ = 0, status_ = 0, cells_ = 0, contacts_ = 0, tf_ = 0, robot_ = 0,
                layout_ = 0, felt_topic_ = 0;
  // Of a faster loop: a browser that falls behind shows the past, and a person's Stop waits for its answer.
  skinctl::detail::Pace plotted_{std::chrono::milliseconds(8)};
  skinctl::detail::Pace drawn_{std::chrono::milliseconds(33)}, said_{std::chrono::milliseconds(100)},
      mapped_{std::chrono::seconds(1)};
  skinctl::Status since_;
  std::uint64_t dropped_ = 0;
};

}  // namespace adapters::live
