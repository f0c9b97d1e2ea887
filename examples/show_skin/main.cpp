// show_skin: a skin in the terminal, live. Without a port a simulated one is touched.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <random>
#include <thread>

#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/skin/sender.hpp"
#include "examples/adapters/socket.hpp"
#include "examples/show_skin/screen.hpp"
#include "examples/support/job.hpp"
#include "examples/support/program.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/io/skin_export.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/sensing/unrest.hpp"

namespace {

using namespace std::chrono_literals;
namespace job = examples::job;
using Clock = std::chrono::steady_clock;
using skinctl::CellSample;
using skinctl::Nanoseconds;

Nanoseconds now() {
  return Clock::now().time_since_epoch();
}

/// A finger that goes from cell to cell, twice a second, and sends what the skin reads: each measurement of
/// its neighbourhood, 250 times a second, and every 25th of the others.
class Finger {
 public:
  static constexpr double noise = 0.7;  ///< of a force sensor [steps]

  Finger(const skinctl::SkinFile& file, std::uint16_t port, const std::optional<adapters::skin::Key>& key)
      : sender_("127.0.0.1", port, key) {
    for (const auto& patch : file.patches)
      for (const auto& cell : patch.cells) cells_.push_back({cell.id, &patch, cell.X_RootCell.p, {}});
  }
  void step() {
    const auto t = now();
    const std::size_t at = static_cast<std::size_t>(t / 500ms * 7) % cells_.size();
    const double depth = static_cast<double>((t % 500ms).count()) / 5e8;
    samples_.clear();
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const auto& p = cells_[i].p;
      const auto& c = cells_[at].p;
      const double d2 = (p.x - c.x) * (p.x - c.x) + (p.y - c.y) * (p.y - c.y) + (p.z - c.z) * (p.z - c.z);
      const double press = cells_[i].patch == cells_[at].patch
                               ? 2 * depth * (1 - depth) * std::exp(-d2 / (2 * 0.02 * 0.02))
                               : 0;
      CellSample sample{.time = t, .cell = cells_[i].id};
      for (float& f : sample.force)
        f = static_cast<float>(std::clamp(std::round(1024 * (0.01 + press) + noise_(random_)), 0.0, 1024.0) /
                               1024);
      sample.proximity = std::min(1.0f, static_cast<float>(0.01 + 3 * press));
      unrest_.measure(cells_[i].unrest, sample);
      if (press < 0.004 && (i + round_) % 25 != 0) continue;
      unrest_.tell(cells_[i].unrest, sample);
      samples_.push_back(sample);
    }
    ++round_;
    sender_.send(samples_, t);
  }

 private:
  struct Cell {
    std::uint32_t id;
    const skinctl::SkinFile::Patch* patch;
    skinctl::Xyz<double> p;
    skinctl::Unrest<>::Memory unrest;
  };
  adapters::skin::Sender sender_;
  std::vector<Cell> cells_;
  std::vector<CellSample> samples_;
  std::size_t round_ = 0;
  skinctl::Unrest<> unrest_;
  std::mt19937 random_{1};
  std::normal_distribution<> noise_{0, noise};
};

struct Options {
  std::string file, key_file;
  adapters::skin::ReceiverConfig receiver;
  show_skin::ScreenSettings screen;
  double seconds = 0, rate = 10;
  bool simulate = false, plain = false;
};

job::Exit run(Options& o, bool simulate) {
  const auto skin = o.file.empty() ? skinctl::ur5_skin_file<260>({}) : skinctl::read_skin_file(o.file);
  if (simulate) o.receiver.noise = Finger::noise;
  if (!o.key_file.empty()) o.receiver.key = adapters::skin::Key::read(o.key_file);
  adapters::skin::Receiver receiver(o.receiver);
  const bool terminal = ::isatty(STDOUT_FILENO) == 1;
  o.screen.colours = terminal && !o.plain;
  show_skin::Screen screen(skin, o.screen);
  std::unique_ptr<Finger> finger;
  if (simulate) finger = std::make_unique<Finger>(skin, receiver.port(), o.receiver.key);
  const job::StopSignals signals;
  const auto start = now();
  auto next = start + 200ms;  // the receiver listens first
  if (terminal) std::printf("\x1b[2J");
  std::uint64_t samples = 0;
  for (;;) {
    if (finger) finger->step();
    const auto t = now();
    const auto news = receiver.poll(t);
    samples += news.size();
    screen.hear(news);
    const bool over =
        signals.asked() || (o.seconds > 0 && t - start > std::chrono::duration<double>(o.seconds));
    if (t >= next || over) {
      char status[160];
      const auto& s = receiver.statistics();
      std::snprintf(
          status, sizeof status, "%zu of %zu cells, %.0f samples/s, %llu lost, %llu stray, %llu unknown%s",
          screen.heard(t), screen.cells(), static_cast<double>(samples) / skinctl::seconds<double>(t - start),
          static_cast<unsigned long long>(s.lost), static_cast<unsigned long long>(s.stray()),
          static_cast<unsigned long long>(screen.unknown()), finger ? "  (simulated)" : "");
      const std::string frozen = receiver.frozen(), refused = adapters::skin::refusals(s);
      const std::string leaps = receiver.leaps();
      std::string text = screen.draw(t, status);
      if (!frozen.empty()) text += frozen + "\n";
      if (!refused.empty()) text += "refused: " + refused + "\n";
      if (!leaps.empty()) text += leaps + "\n";
      if (terminal) {  // in place, and what is left of longer lines goes
        std::string lines = "\x1b[H";
        for (const char c : text) lines += c == '\n' ? std::string("\x1b[K\n") : std::string(1, c);
        text = lines + "\x1b[J";
      }
      std::fputs(text.c_str(), stdout);
      std::fflush(stdout);
      while (next <= t)
        next += std::chrono::duration_cast<Nanoseconds>(std::chrono::duration<double>(1 / o.rate));
    }
    if (over) {
      if (signals.asked()) return job::Exit::interrupted;
      return receiver.heard() ? job::Exit::fine : job::Exit::blind;
    }
    std::this_thread::sleep_for(4ms);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "A skin in the terminal, live: . at rest, 1 to 9 pressed, o near something, x silent, ? never heard."};
  app.footer(job::exit_help());
  Options o;
  auto* port = app.add_option("--port", o.receiver.port, "that its datagrams come to");
  app.add_flag("--simulate", o.simulate, "a simulated skin (the default without --port)")->excludes(port);
  app.add_option("--address", o.receiver.address, "of this computer")->capture_default_str();
  app.add_option("--sender", o.receiver.sender, "the only address that is listened to");
  app.add_option("--key", o.key_file, "file with the key of sealed datagrams")->check(CLI::ExistingFile);
  app.add_option("--noise", o.receiver.noise,
                 "of a force sensor at rest [steps]: above 0.3, frozen cells are named; 0: not known")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  app.add_option("--skin", o.file, "skin file; without it that of the UR5 with 260 cells")
      ->check(CLI::ExistingFile);
  app.add_option("--width", o.screen.width, "of the terminal")
      ->check(CLI::Range(20, 1000))
      ->capture_default_str();
  app.add_option("--full", o.screen.full, "reading that is shown as 9")
      ->check(CLI::Range(0.001, 1.0))
      ->capture_default_str();
  app.add_option("--rate", o.rate, "pictures a second")->check(CLI::Range(0.1, 100.0))->capture_default_str();
  app.add_option("--seconds", o.seconds, "ends after so long; 0: at a signal")->check(CLI::NonNegativeNumber);
  app.add_flag("--plain", o.plain, "without colours");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  try {
    return job::code(run(o, port->count() == 0));
  } catch (const adapters::ConnectionError& e) {
    std::fprintf(stderr, "show_skin: %s\n", e.what());
    return job::code(job::Exit::lost);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "show_skin: %s\n", e.what());
    return job::code(job::Exit::refused);
  }
}
