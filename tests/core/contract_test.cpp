#include "skinctl/core/contract.hpp"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <limits>
#include <string>

using namespace skinctl;

TEST_CASE("require: lets pass what is allowed, and else names the quantity, its value and the range") {
  CHECK_NOTHROW(require(true, "K_p", 8.5, "> 0 1/s"));
  CHECK_THROWS_WITH_AS(require(false, "K_p", -0.25, "> 0 1/s"), "skinctl: K_p = -0.25, allowed: > 0 1/s",
                       ConfigurationError);
  CHECK_THROWS_AS(require(false, "K_p", -0.25, "> 0 1/s"), std::invalid_argument);
}

TEST_CASE("require: a NaN satisfies no range") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(require(nan > 0.0, "K_p", nan, "> 0 1/s"), "skinctl: K_p = nan, allowed: > 0 1/s",
                       ConfigurationError);
}

TEST_CASE("require: prints enough digits to tell a number from the limit it missed") {
  CHECK_THROWS_WITH_AS(require(false, "weight", 1.00000001, "<= 1"),
                       "skinctl: weight = 1.00000001, allowed: <= 1", ConfigurationError);
  CHECK_THROWS_WITH_AS(require(false, "weight", -1.7976931348623157e308, "<= 1"),
                       "skinctl: weight = -1.79769313e+308, allowed: <= 1", ConfigurationError);
}

TEST_CASE("SKINCTL_THROW: is an exception where there are exceptions") {
  CHECK_THROWS_WITH_AS(SKINCTL_THROW("no such link"), "no such link", ConfigurationError);
}

TEST_CASE("set_error_handler: gives back what it replaces") {
  const ErrorHandler mine = [](const char*) noexcept {};
  const ErrorHandler before = set_error_handler(mine);
  CHECK((before != nullptr));
  CHECK((set_error_handler(before) == mine));
}

namespace {
/// How a process ends that runs `f`: killed by a signal, or its text on stderr.
struct End {
  int signal;
  std::string text;
};
template <class F>
End end_of(F f) {
  int pipe_ends[2];
  REQUIRE(pipe(pipe_ends) == 0);
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    dup2(pipe_ends[1], STDERR_FILENO);
    close(pipe_ends[0]);
    std::signal(SIGABRT, SIG_DFL);  // doctest's handler would report the child as a failed test
    f();
    _exit(0);
  }
  close(pipe_ends[1]);
  End end{0, {}};
  char buffer[256];
  for (ssize_t n; (n = read(pipe_ends[0], buffer, sizeof buffer)) > 0;)
    end.text.append(buffer, static_cast<std::size_t>(n));
  close(pipe_ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  return end;
}
}  // namespace

TEST_CASE(
    "SKINCTL_EXPECTS: stops a debug build with the promise that broke, and is nothing in a release build") {
  const End kept = end_of([] { SKINCTL_EXPECTS(1 + 1 == 2, "arithmetic"); });
  CHECK(kept.signal == 0);
  CHECK(kept.text.empty());
  int evaluated = 0;
  SKINCTL_EXPECTS(++evaluated > 0, "counts its evaluation");
  const End broken = end_of([] { SKINCTL_EXPECTS(1 + 1 == 3, "arithmetic"); });
#if defined(NDEBUG)
  CHECK(evaluated == 0);
  CHECK(broken.signal == 0);
#else
  CHECK(evaluated == 1);
  CHECK(broken.signal == SIGABRT);
  CHECK(broken.text == "skinctl: broken promise: arithmetic\n");
#endif
}
