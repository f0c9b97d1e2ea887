// A skin of 1260 cells over DDS for minutes: samples, losses and latencies from Fast DDS to itself, to
// Cyclone DDS and back. `dds_minutes [seconds]` prints a table. All in one process on 127.0.0.1, every reader
// in a thread of its own.
#include <dds/dds.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "examples/adapters/dds/skin.hpp"
#include "examples/adapters/dds/tests/cyclone_participant.hpp"
#include "ros.h"
#include "skinctl/cycle/stopwatch.hpp"
#include "skinctl/hardware/histogram.hpp"

using namespace skinctl;
using namespace adapters::dds;

namespace {

constexpr std::uint32_t domain = 80, cells = 1260;
std::atomic<bool> ending{false};

struct Way {
  const char* name;
  std::uint64_t received = 0;
  Histogram latency{};

  void arrived(Nanoseconds stamp) {
    ++received;
    latency.record(Stopwatch::now() - stamp);
  }
  void print(std::uint64_t of) const {
    const auto us = [&](double share) { return 1e-3 * double(latency.percentile(share).count()); };
    std::printf("| %s | %llu | %llu | %llu | %.0f | %.0f | %.0f |\n", name,
                static_cast<unsigned long long>(of), static_cast<unsigned long long>(received),
                static_cast<unsigned long long>(of - received), us(0.5), us(0.99),
                1e-3 * double(latency.max().count()));
  }
};

/// The stamp of a message of ours, behind the four bytes of the header.
Nanoseconds stamp_of(std::span<const unsigned char> message) {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  std::memcpy(&sec, message.data() + 4, 4), std::memcpy(&nanosec, message.data() + 8, 4);
  return std::chrono::seconds(sec) + Nanoseconds(nanosec);
}

int measure(double seconds_long) {
  std::vector<SkinCloud::Cell> homes;
  for (std::uint32_t i = 0; i < cells; ++i) homes.push_back({i + 1, i / 210, {0.001f * float(i), 0.5f, -1}});
  SkinCloud cloud(homes);
  // The peers' entities.
  const dds_entity_t peer = adapters::dds::testing::cyclone_participant(domain);
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
  const auto topic = [&](const char* name) {
    return dds_create_topic(peer, &sensor_msgs_msg_dds__PointCloud2__desc, name, nullptr, nullptr);
  };
  const auto their_reader = dds_create_reader(peer, topic("rt/skin/cells"), qos, nullptr);
  const auto their_writer = dds_create_writer(peer, topic("rt/skin/again"), qos, nullptr);
  dds_delete_qos(qos);
  const auto condition = dds_create_readcondition(their_reader, DDS_ANY_STATE);
  const auto waits = dds_create_waitset(peer);
  if (dds_waitset_attach(waits, condition, 0) != DDS_RETCODE_OK) return 1;
  // Ours.
  Participant first({.domain = domain}), second({.domain = domain});
  RawWriter writer(first, "/skin/cells", SkinCloud::type(), Delivery::sensor, skin_cloud_size(cells));
  RawReader same(second, "/skin/cells", SkinCloud::type(), Delivery::sensor, skin_cloud_size(cells));
  RawReader back(second, "/skin/again", SkinCloud::type(), Delivery::sensor, skin_cloud_size(cells));
  for (int k = 0; k < 1000 && (writer.readers() < 2 || back.writers() < 1); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  if (writer.readers() < 2 || back.writers() < 1) {
    std::fprintf(stderr, "the three have not found one another\n");
    return 1;
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));

  // Cyclone's own structure of the same message, filled by hand.
  std::vector<sensor_msgs_msg_dds__PointField_> fields;
  std::vector<std::string> names;
  for (const auto& f : SkinPoint::fields) names.emplace_back(f.name);
  for (std::size_t i = 0; i < names.size(); ++i)
    fields.push_back({names[i].data(), SkinPoint::fields[i].offset,
                      static_cast<std::uint8_t>(SkinPoint::fields[i].number), 1});
  std::vector<std::uint8_t> data(cells * sizeof(SkinPoint));
  std::string frame = "base_link";
  sensor_msgs_msg_dds__PointCloud2_ theirs{};
  theirs.header_.frame_id_ = frame.data();
  theirs.height_ = 1, theirs.width_ = cells;
  theirs.fields_._buffer = fields.data();
  theirs.fields_._length = theirs.fields_._maximum = static_cast<std::uint32_t>(fields.size());
  theirs.point_step_ = sizeof(SkinPoint), theirs.row_step_ = static_cast<std::uint32_t>(data.size());
  theirs.data_._buffer = data.data();
  theirs.data_._length = theirs.data_._maximum = static_cast<std::uint32_t>(data.size());
  theirs.is_dense_ = true;

  Way to_same{"Fast DDS to Fast DDS"}, to_peer{"Fast DDS to Cyclone"}, from_peer{"Cyclone to Fast DDS"};
  const auto read_ours = [](RawReader& reader, Way& way) {
    while (!ending)
      if (reader.wait(std::chrono::milliseconds(50)))
        if (const auto bytes = reader.take()) way.arrived(stamp_of(*bytes));
  };
  std::thread a([&] { read_ours(same, to_same); }), b([&] { read_ours(back, from_peer); }), c([&] {
    while (!ending) {
      dds_attach_t which = 0;
      if (dds_waitset_wait(waits, &which, 1, DDS_MSECS(50)) <= 0) continue;
      sensor_msgs_msg_dds__PointCloud2_ got{};
      void* at = &got;
      dds_sample_info_t info;
      while (dds_take(their_reader, &at, &info, 1, 1) == 1)
        if (info.valid_data)
          to_peer.arrived(std::chrono::seconds(got.header_.stamp_.sec_) +
                          Nanoseconds(got.header_.stamp_.nanosec_));
      dds_sample_free(&got, &sensor_msgs_msg_dds__PointCloud2__desc, DDS_FREE_CONTENTS);
    }
  });
  const auto frames = static_cast<std::uint64_t>(250 * seconds_long);
  Histogram write, late;
  auto next = std::chrono::steady_clock::now();
  std::uint64_t ours = 0, back_sent = 0;
  for (std::uint64_t k = 0; k < frames; ++k) {
    next += std::chrono::milliseconds(4);
    std::this_thread::sleep_until(next);
    const Nanoseconds now = Stopwatch::now();
    late.record(now - next.time_since_epoch());
    for (std::uint32_t i = 0; i < 164; ++i)
      cloud.set({now - 1ms, 1 + static_cast<std::uint32_t>((k * 164 + i) % cells), {0.1f, 0, 0}, 0, {}, 30});
    const auto message = cloud.encode(now);
    ours += writer.write(message);
    write.record(Stopwatch::now() - now);
    const Nanoseconds then = Stopwatch::now();
    theirs.header_.stamp_.sec_ = static_cast<std::int32_t>(then.count() / 1'000'000'000);
    theirs.header_.stamp_.nanosec_ = static_cast<std::uint32_t>(then.count() % 1'000'000'000);
    back_sent += dds_write(their_writer, &theirs) == DDS_RETCODE_OK;
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  ending = true;
  a.join(), b.join(), c.join();
  std::printf("1260 cells, 250 frames a second, %.0f s\n\n", seconds_long);
  std::printf(
      "| way | sent | received | lost | latency [us], median | p99 | max |\n|---|---|---|---|---|---|---|\n");
  to_same.print(ours), to_peer.print(ours), from_peer.print(back_sent);
  std::uint64_t very = 0;
  late.for_each([&](Nanoseconds end, std::uint64_t n) { very += end > 1ms ? n : 0; });
  std::printf(
      "\nencoding and writing to two readers: median %.0f us, p99 %.0f, max %.0f; the sender was woken more "
      "than 1 ms "
      "late %llu times, %.1f ms at most\n",
      1e-3 * double(write.percentile(0.5).count()), 1e-3 * double(write.percentile(0.99).count()),
      1e-3 * double(write.max().count()), static_cast<unsigned long long>(very),
      1e-6 * double(late.max().count()));
  dds_delete(peer);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return measure(argc > 1 ? std::atof(argv[1]) : 120);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "dds_minutes: %s\n", e.what());
    return 1;
  }
}
