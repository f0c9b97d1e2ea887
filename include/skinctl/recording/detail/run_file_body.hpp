// SPDX-License-Identifier: BSD-3-Clause
// A run on its way into an MCAP file: messages, channels, the file.
#pragma once

#include <chrono>

#include "skinctl/io/detail/compiled.hpp"
#include "skinctl/recording/detail/pace.hpp"
#include "skinctl/recording/mcap_file.hpp"
#include "skinctl/recording/run_file.hpp"
#include "skinctl/recording/run_messages.hpp"

SKINCTL_BEGIN_NAMESPACE

struct RunFile::Inside {
  Inside(const std::string& path, RunDescription run, std::size_t joints_of_robot, std::size_t laws)
      : messages(std::move(run), joints_of_robot, laws), sink(path) {}

  RunMessages messages;
  FileSink sink;
  McapWriter<FileSink> writer{sink};
  McapChannel start, cycle, joints, shares, status, cells, contacts, tf, robot, layout;
  detail::Pace picture{33ms}, said{100ms};
  Status since{};
  std::uint64_t cycles = 0, dropped = 0;
  std::chrono::steady_clock::time_point flushed = std::chrono::steady_clock::now();
};

SKINCTL_IO RunFile::RunFile(const std::string& path, const std::map<std::string, std::string>& facts,
                            RunDescription run, std::size_t joints, std::size_t laws)
    : inside_(new Inside(path, std::move(run), joints, laws)) {
  auto& to = *inside_;
  to.writer.metadata("skinctl", facts);
  to.start = to.writer.channel(CycleTopic::start, CycleTopic::start_encoding);
  to.cycle = to.writer.channel(CycleTopic::cycle, CycleTopic::cycle_encoding);
  to.joints = to.writer.channel("/joint_states", ros::JointState::type());
  to.shares = to.writer.channel("/skinctl/torque_shares", ros::Matrix::type());
  to.status = to.writer.channel("/skinctl/status", ros::String::type());
  to.cells = to.writer.channel("/skin/cells", SkinCloud::type());
  to.contacts = to.writer.channel("/skin/contacts", ros::PointCloud::type());
  to.tf = to.writer.channel("/tf", ros::Transforms::type());
  to.robot = to.writer.channel("/robot_description", ros::String::type());
  to.layout = to.writer.channel("/skin/layout", ros::String::type());
}
SKINCTL_IO RunFile::~RunFile() = default;

SKINCTL_IO void RunFile::start(Nanoseconds now, std::span<const unsigned char> bytes) {
  auto& to = *inside_;
  to.writer.write(to.start, now, bytes);
  const auto latched = [&](McapChannel channel, const std::string& text) {
    if (!text.empty()) to.writer.write(channel, now, to.messages.encoded(ros::String{text}));
  };
  latched(to.robot, to.messages.run().urdf);
  latched(to.layout, to.messages.run().layout);
}

SKINCTL_IO void RunFile::cycle(const CycleNumbers& r) {
  auto& to = *inside_;
  const Nanoseconds now = r.now;
  to.writer.write(to.cycle, now, r.bytes, r.number);
  to.messages.take(r);
  to.since |= r.status;
  ++to.cycles;
  to.writer.write(to.joints, now, to.messages.joint_states(r));
  to.writer.write(to.shares, now, to.messages.torque_shares(r));
  if (to.picture.due(now)) {
    if (const auto bytes = to.messages.cells(r); !bytes.empty()) to.writer.write(to.cells, now, bytes);
    if (const auto bytes = to.messages.contacts(r); !bytes.empty()) to.writer.write(to.contacts, now, bytes);
    if (const auto bytes = to.messages.tf(r); !bytes.empty()) to.writer.write(to.tf, now, bytes);
  }
  if (to.said.due(now)) {
    to.writer.write(to.status, now, to.messages.status(r, to.since, to.dropped));
    to.since = Status();
  }
}

SKINCTL_IO void RunFile::pause(std::uint64_t dropped) {
  auto& to = *inside_;
  to.dropped = dropped;
  const auto now = std::chrono::steady_clock::now();
  if (now - to.flushed < std::chrono::seconds(1)) return;
  to.flushed = now;
  to.writer.flush();
}

SKINCTL_IO bool RunFile::finish() {
  const bool whole = inside_->writer.finish();
  return whole && inside_->writer.lost() == 0 && inside_->dropped == 0;
}
SKINCTL_IO std::uint64_t RunFile::cycles() const noexcept {
  return inside_->cycles;
}
SKINCTL_IO std::uint64_t RunFile::lost() const noexcept {
  return inside_->writer.lost();
}
SKINCTL_IO std::uint64_t RunFile::size() const noexcept {
  return inside_->writer.size();
}

SKINCTL_END_NAMESPACE
