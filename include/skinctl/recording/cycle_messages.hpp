// SPDX-License-Identifier: BSD-3-Clause
// The cycles of a scene as ROS 2 messages.
#pragma once

#include <utility>

#include "skinctl/recording/numbers_of.hpp"
#include "skinctl/recording/run_messages.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `RunMessages` for the cycles of a scene.
template <class C>
class CycleMessages {
 public:
  using Bytes = RunMessages::Bytes;
  using Record = CycleRecord<C>;

  /// Throws where `RunMessages` does.
  explicit CycleMessages(RunDescription run)
      : messages_(std::move(run), NumbersOf<C>::joints, NumbersOf<C>::laws) {}
  [[nodiscard]] const RunDescription& run() const noexcept { return messages_.run(); }
  [[nodiscard]] SkinCloud& cloud() noexcept { return messages_.cloud(); }

  void take(const Record& r) { messages_.take(numbers_(r)); }
  [[nodiscard]] Bytes tf(const Record& r) { return messages_.tf(numbers_(r)); }
  [[nodiscard]] Bytes cells(const Record& r) { return messages_.cells(numbers_(r)); }
  [[nodiscard]] Bytes contacts(const Record& r) { return messages_.contacts(numbers_(r)); }
  const std::vector<LinkPlace>& places(const Record& r) { return messages_.places(numbers_(r)); }
  [[nodiscard]] Bytes joint_states(const Record& r) { return messages_.joint_states(numbers_(r)); }
  [[nodiscard]] Bytes torque_shares(const Record& r) { return messages_.torque_shares(numbers_(r)); }
  [[nodiscard]] Bytes status(const Record& r, Status since_last, std::uint64_t dropped) {
    return messages_.status(numbers_(r), since_last, dropped);
  }
  template <class M>
  [[nodiscard]] Bytes encoded(const M& message) {
    return messages_.encoded(message);
  }

 private:
  RunMessages messages_;
  NumbersOf<C> numbers_;
};

SKINCTL_END_NAMESPACE
