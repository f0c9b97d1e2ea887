// What programs share: exit codes, signals, progress.
#include "examples/support/job.hpp"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <set>
#include <string>

using namespace examples::job;

TEST_CASE("job: every exit code is told apart, has words, and only one of them is 0") {
  std::set<int> codes;
  for (const ExitRow& r : exits) {
    CHECK(codes.insert(code(r.exit)).second);
    CHECK(std::string(r.words).size() > 10);
    CHECK(row(r.exit).name == r.name);
    CHECK((code(r.exit) == 0) == (r.exit == Exit::fine));
    CHECK(exit_help().find(r.words) != std::string::npos);
  }
}

TEST_CASE(
    "job: the first signal asks for a stop, as do two at once; a later one ends the process; a reader that "
    "leaves does "
    "neither") {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    {
      const StopSignals signals;
      CHECK_FALSE(signals.asked());
      ::raise(SIGPIPE);
      CHECK_FALSE(signals.asked());
      ::raise(number);
      CHECK(signals.asked());
    }
    const auto ends = [&](bool late) {
      const pid_t child = ::fork();
      if (child == 0) {
        const StopSignals signals;
        ::raise(number);
        ::raise(number);
        if (late) {
          ::usleep(300'000);
          ::raise(number);
        }
        ::_exit(signals.asked() ? 7 : 8);
      }
      int status = 0;
      REQUIRE(::waitpid(child, &status, 0) == child);
      return status;
    };
    const int at_once = ends(false), late = ends(true);
    REQUIRE(WIFEXITED(at_once));
    CHECK(WEXITSTATUS(at_once) == 7);
    REQUIRE(WIFSIGNALED(late));
    CHECK(WTERMSIG(late) == number);
  }
}

TEST_CASE("job: progress is a line now and then where nobody looks, and nothing when quiet") {
  std::FILE* file = std::tmpfile();
  REQUIRE(file != nullptr);
  {
    Progress loud(false, 1, file), quiet(true, 1, file);
    for (int k = 0; k < 250; ++k) {
      if (loud.due(0.1 * k)) loud.show("%4.0f s", 0.1 * k);
      if (quiet.due(0.1 * k)) quiet.show("never");
    }
  }
  std::rewind(file);
  char text[200] = {};
  const auto n = std::fread(text, 1, sizeof text - 1, file);
  std::fclose(file);
  CHECK(std::string(text, n) == "   0 s\n  10 s\n  20 s\n");
}
