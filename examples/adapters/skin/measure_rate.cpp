// How many samples a second the receiver takes without a loss: a thread sends full datagrams at a steady rate
// over the loopback, another polls each millisecond, as a loop would. Losses are counted from the sequence
// numbers.
//
//   skin_receiver_rate [seconds 60] [samples a second 1e6] [sealed 0 or 1]
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "examples/adapters/skin/receiver.hpp"
#include "examples/support/job.hpp"
#include "examples/support/program.hpp"

using namespace adapters::skin;
using Clock = std::chrono::steady_clock;
using std::chrono::nanoseconds;

namespace {

constexpr std::size_t batch = 64;
constexpr std::uint32_t cells = 100'000;

nanoseconds now() {
  return std::chrono::duration_cast<nanoseconds>(Clock::now().time_since_epoch());
}
double busy_of_this_thread() {
  rusage use{};
  getrusage(RUSAGE_THREAD, &use);
  const auto s = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return s(use.ru_utime) + s(use.ru_stime);
}

/// Sends `total` datagrams of `samples` samples at a steady rate; gives how many it sent late by 5 ms and
/// more.
std::uint64_t send_all(std::uint16_t port, std::uint64_t total, std::size_t samples, double a_second,
                       const std::optional<Key>& key, const std::atomic<bool>& stop) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int handle = ::socket(AF_INET, SOCK_DGRAM, 0);
  if (handle < 0 || ::connect(handle, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) std::abort();
  std::vector<std::array<std::uint8_t, largest>> bytes(batch);
  std::vector<skinctl::CellSample> news(samples);
  Question question{};
  const auto listen = [&] {
    std::array<std::uint8_t, QuestionBytes().size()> heard;
    while (key && ::recv(handle, heard.data(), heard.size(), MSG_DONTWAIT) == ssize_t(heard.size()))
      static_cast<void>(parse_question(heard, *key, question));
  };
  std::array<iovec, batch> part{};
  std::array<mmsghdr, batch> message{};
  for (std::size_t i = 0; i < batch; ++i)
    message[i].msg_hdr.msg_iov = &part[i], message[i].msg_hdr.msg_iovlen = 1;
  if (key) {  // the first one answers nothing, and is asked at once
    const std::size_t size = write(bytes[0], 0, now(), {}, &question);
    while (!stop && question == Question{}) {
      static_cast<void>(::send(handle, bytes[0].data(), key->seal(Sealed::samples, bytes[0], size), 0));
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      listen();
    }
  }
  const auto start = Clock::now();
  std::uint64_t sent = 0, late = 0;
  std::uint32_t cell = 0;
  while (sent < total && !stop) {
    const double t = std::chrono::duration<double>(Clock::now() - start).count();
    const auto due = std::min<std::uint64_t>(total, static_cast<std::uint64_t>(t * a_second) + 1);
    if (due <= sent) {
      std::this_thread::sleep_for(std::chrono::microseconds(200));
      continue;
    }
    const std::size_t n = std::min<std::uint64_t>(batch, due - sent);
    if (double(due - sent) > 5e-3 * a_second) late += n;
    const std::int64_t time = now().count();
    listen();
    for (std::size_t i = 0; i < n; ++i) {
      auto& b = bytes[i];
      for (skinctl::CellSample& sample : news) {
        sample = {.time = nanoseconds(time), .cell = cell, .force = {0.25f}, .measured = 1, .unrest = 1};
        cell = (cell + 1) % cells;
      }
      std::size_t size = write(b, static_cast<std::uint32_t>(sent + i + 1), nanoseconds(time),
                               std::span(std::as_const(news)), key ? &question : nullptr);
      if (key) size = key->seal(Sealed::samples, b, size);
      part[i] = {b.data(), size};
    }
    std::size_t done = 0;
    while (done < n) {
      const int k = ::sendmmsg(handle, message.data() + done, static_cast<unsigned>(n - done), 0);
      if (k > 0) done += static_cast<std::size_t>(k);
    }
    sent += n;
  }
  return late;
}

}  // namespace

int main(int argc, char** argv) {
  namespace job = examples::job;
  double seconds = 60, rate = 1e6;
  bool sealed = false, simulate = false;
  CLI::App app{
      "Measures how many samples a second the skin's receiver takes from a sender on loopback without a "
      "loss."};
  app.footer(job::exit_help());
  app.add_option("seconds", seconds)->check(CLI::Range(1e-3, 3600.0))->capture_default_str();
  app.add_option("rate", rate, "samples a second")->check(CLI::Range(1e3, 1e8))->capture_default_str();
  app.add_option("sealed", sealed, "1: authenticated datagrams");
  app.add_flag("--simulate", simulate, "a simulated skin (there is no other)");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  const job::StopSignals signals;
  std::optional<Key> key;
  if (sealed) key.emplace(std::array<std::uint8_t, Key::size>{1, 2, 3});
  constexpr std::size_t samples = max_samples(skinctl::KindTable<skinctl::Hexagon>::readings);
  const double a_second = rate / double(samples);
  const auto total = static_cast<std::uint64_t>(seconds * a_second);

  Receiver receiver(
      {.key = key, .max_samples = 1 << 17, .max_datagrams = 1 << 13, .clock = {.gather = nanoseconds(0)}});
  std::atomic<bool> sending = true;
  std::uint64_t late = 0;
  std::thread sender([&] {
    late = send_all(receiver.port(), total, samples, a_second, key, signals.asked());
    sending = false;
  });
  double checksum = 0, longest = 0;
  const double busy = busy_of_this_thread();
  const auto start = Clock::now();
  auto next = start;
  for (bool last = false; !last;) {
    last = !sending;  // what was sent before is in the socket
    const auto began = Clock::now();
    for (const auto& sample : receiver.poll(now())) checksum += sample.force[0];
    longest = std::max(longest, std::chrono::duration<double>(Clock::now() - began).count());
    next = std::max(next + std::chrono::milliseconds(1), Clock::now());
    std::this_thread::sleep_until(next);
  }
  const double took = std::chrono::duration<double>(Clock::now() - start).count();
  const double used = busy_of_this_thread() - busy;
  sender.join();
  if (signals.asked()) return job::code(job::Exit::interrupted);

  const Statistics& s = receiver.statistics();
  const std::uint64_t missing = total - s.datagrams;
  std::printf("%s datagrams of %zu samples, receive buffer %.1f MB\n", sealed ? "sealed" : "open", samples,
              1e-6 * double(receiver.buffer()));
  std::printf("sent %llu samples in %.1f s (%.3g a second; %.2f %% of them late by 5 ms and more)\n",
              static_cast<unsigned long long>(total * samples), took, double(total * samples) / took,
              100.0 * double(late) / double(total));
  std::printf("received %llu samples, lost %llu datagrams by sequence numbers, %llu of those sent\n",
              static_cast<unsigned long long>(s.samples), static_cast<unsigned long long>(s.lost),
              static_cast<unsigned long long>(missing));
  std::printf("refused: %llu strays, %llu late, %llu bad samples\n",
              static_cast<unsigned long long>(s.stray()), static_cast<unsigned long long>(s.late),
              static_cast<unsigned long long>(s.bad_samples));
  std::printf("receiver: %.1f %% of a core, %.0f ns a sample, longest poll %.2f ms\n", 100 * used / took,
              1e9 * used / double(s.samples), 1e3 * longest);
  // Every datagram is accounted for: received, or missed in the sequence but for those after the last one.
  const bool whole =
      s.samples == s.datagrams * samples && checksum == 0.25 * double(s.samples) && s.lost <= missing;
  std::printf("every datagram is accounted for: %s\n", whole && s.datagrams > 0 ? "yes" : "no");
  return whole && s.datagrams > 0 ? (missing == 0 ? 0 : 1) : 3;
}
