// What the programs that move a device share: a clean stop on signals, progress lines, exit codes with words.
#pragma once

#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <stdexcept>
#include <string>

#include "examples/support/exit.hpp"

namespace examples::job {

namespace detail {
inline std::atomic<bool> stop_asked{false};
/// When the first signal came, by the monotonic clock [ns]; 0 before.
inline std::atomic<std::int64_t> stop_asked_at{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::int64_t>::is_always_lock_free,
              "set by a signal handler");
}  // namespace detail

/// While it lives, the first SIGINT, SIGTERM or SIGHUP sets `asked()`, and another one 0.2 s later or more
/// ends the process as usual: who signals a process and its group, as timeout(1) does, asks once. A reader of
/// standard output that goes away does not end a program that has a device to stop, nor later, when the rest
/// of the output is written at exit. One at a time.
class StopSignals {
 public:
  StopSignals() {
    detail::stop_asked = false;
    detail::stop_asked_at = 0;
    struct sigaction stop{};
    stop.sa_handler = [](int number) {
      timespec t{};
      ::clock_gettime(CLOCK_MONOTONIC, &t);
      const std::int64_t now = std::int64_t{1'000'000'000} * t.tv_sec + t.tv_nsec;
      std::int64_t first = 0;
      if (detail::stop_asked_at.compare_exchange_strong(first, now)) {
        detail::stop_asked = true;
      } else if (now - first > 200'000'000) {
        ::signal(number, SIG_DFL);
        ::raise(number);
      }
    };
    for (std::size_t k = 0; k < caught.size(); ++k) install(caught[k], stop, before_[k]);
    struct sigaction ignore{};
    ignore.sa_handler = SIG_IGN;
    install(SIGPIPE, ignore, pipe_before_);
  }
  ~StopSignals() {
    for (std::size_t k = 0; k < caught.size(); ++k) ::sigaction(caught[k], &before_[k], nullptr);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  [[nodiscard]] const std::atomic<bool>& asked() const noexcept { return detail::stop_asked; }

 private:
  static constexpr std::array<int, 3> caught{SIGINT, SIGTERM, SIGHUP};
  static void install(int number, const struct sigaction& action, struct sigaction& before) {
    if (::sigaction(number, &action, &before) != 0)
      throw std::runtime_error("cannot catch signal " + std::to_string(number));
  }
  std::array<struct sigaction, caught.size()> before_{};
  struct sigaction pipe_before_{};
};

/// One line that is written over on a terminal, and a line now and then elsewhere. Nothing when quiet.
class Progress {
 public:
  /// @param every  seconds of the job's time between two lines on a terminal; ten times that elsewhere.
  explicit Progress(bool quiet, double every = 1, std::FILE* out = stdout)
      : out_(quiet ? nullptr : out),
        terminal_(!quiet && ::isatty(::fileno(out)) == 1),
        every_(terminal_ ? every : 10 * every) {}
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Whether a line is due at `t` seconds: then format one.
  [[nodiscard]] bool due(double t) noexcept {
    if (out_ == nullptr || t < next_) return false;
    next_ = t + every_;
    return true;
  }
  /// As printf.
  __attribute__((format(printf, 2, 3))) void show(const char* format, ...) noexcept {
    if (out_ == nullptr) return;
    char text[100];
    va_list values;
    va_start(values, format);
    std::vsnprintf(text, sizeof text, format, values);
    va_end(values);
    if (terminal_)
      std::fprintf(out_, "\r%-78.78s", text);
    else
      std::fprintf(out_, "%s\n", text);
    std::fflush(out_);
    shown_ = terminal_;
  }
  /// Takes the line away, before others are written.
  void clear() noexcept {
    if (shown_) std::fprintf(out_, "\r%78s\r", "");
    shown_ = false;
  }

 private:
  std::FILE* out_;
  bool terminal_, shown_ = false;
  double every_, next_ = 0;
};

}  // namespace examples::job
