// Presses the arm of a live main job by its page in headless Chromium: by the pointer, dragged, and by keys;
// it gives way, goes back, and the job goes on until it is stopped. Ends with 77 (ctest: skipped) without
// Chromium. `--keep FOLDER` leaves a screenshot behind.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>
#include <signal.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "examples/support/devtools.hpp"

namespace browser = examples::browser;

namespace {

constexpr int skipped = 77;
std::string chromium;
std::filesystem::path keep;

/// The main job as a user starts it, without scripted fingers and goals, which would press and move it
/// meanwhile.
struct Job {
  explicit Job(const std::filesystem::path& folder) {
    const auto scenario = folder / "nobody.toml";
    std::ofstream(scenario) << "[run]\nduration = 60\n";
    pipe = ::popen(("echo $$; exec '" COMPLIANT_UR5_PROGRAM "' --live --live-port 0 --report '' --scenario " +
                    scenario.string() + " 2>&1")
                       .c_str(),
                   "r");
    REQUIRE(pipe != nullptr);
    REQUIRE(std::fscanf(pipe, "%d", &process) == 1);
  }
  ~Job() {
    if (pipe == nullptr) return;
    ::kill(process, SIGKILL);
    ::pclose(pipe);
  }
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;
  std::string url() {
    char line[256];
    while (std::fgets(line, sizeof line, pipe) != nullptr)
      if (const std::string text = line; text.starts_with("live: "))
        return text.substr(6, text.find('\n') - 6);
    return {};
  }
  /// Its exit code after a signal.
  int end(int signal) {
    ::kill(process, signal);
    char line[256];
    while (std::fgets(line, sizeof line, pipe) != nullptr) {
    }
    const int status = ::pclose(std::exchange(pipe, nullptr));
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::FILE* pipe = nullptr;
  int process = 0;
};

// What all contacts of the last cloud sum up to [N].
constexpr char force[] =
    "(c => { let sum = 0; for (let i = 0; c && i < c.count; ++i) sum += Math.hypot(...['fx', 'fy', 'fz'].map("
    "f => c.view.getFloat32(i * c.step + c.fields[f], true))); return sum; })((skinctl.timeline.list("
    "'/skin/contacts').slice(-1)[0] || {}).value)";
const std::string felt = force;

}  // namespace

TEST_CASE("The live page of a simulated run: the pointer presses the arm, which gives way and goes back") {
  const browser::Folder folder;
  Job job(folder.path);
  browser::Page page(chromium, folder);
  page.window(1400, 1000);
  const std::string url = job.url();
  page.go(url);
  REQUIRE(page.until("(skinctl.view && skinctl.view.drawn > 5 && skinctl.layout) || skinctl.no3d"));
  if (page.evaluate("!!skinctl.no3d") == true) {
    MESSAGE("no picture of the robot: " << page.evaluate("skinctl.no3d").dump());
    return;
  }
  REQUIRE(page.until("!document.getElementById('finger').hidden"));
  REQUIRE(page.until("document.getElementById('state').textContent === 'at rest'"));
  // A place of the forearm that is seen, in pixels and as the picture counts; the arm moves meanwhile.
  const auto spot = [&] {
    const auto at = page.evaluate(R"js((() => {
    const v = skinctl.view, b = v.canvas.getBoundingClientRect(); let sum = [0, 0], n = 0;
    for (let x = -0.98; x < 1; x += 0.04) for (let y = -0.98; y < 1; y += 0.04) {
      const hit = v.pick(x, y);
      if (hit && hit.link === 'forearm_link') sum = [sum[0] + x, sum[1] + y], ++n;
    }
    const at = n ? [sum[0] / n, sum[1] / n] : null;
    return at && v.pick(...at) && v.pick(...at).link === 'forearm_link' ? [b.left + (0.5 + 0.5 * at[0]) * b.width, b.top + (0.5 - 0.5 * at[1]) * b.height, ...at] : null;
  })())js");
    REQUIRE(at.is_array());
    return std::array<double, 4>{at[0], at[1], at[2], at[3]};
  };
  CHECK(page.until(felt + " < 1"));
  const auto first = spot();
  const double x = first[0], y = first[1];
  page.mouse("mouseMoved", x, y);
  page.mouse("mousePressed", x, y);
  CHECK(page.until(felt + " > 5"));
  CHECK(page.until("document.getElementById('state').textContent === 'giving way'"));
  CHECK(
      page.until("/^On the finger: .* at most [1-9]/.test(document.getElementById('pressed').textContent)"));
  CHECK(page.evaluate("skinctl.view.finger.visible") == true);
  if (!keep.empty()) page.picture(keep / "live_page_pressed.png");
  page.mouse("mouseMoved", x + 40, y);
  ::usleep(500'000);
  page.mouse("mouseReleased", x + 40, y);
  CHECK(page.until(felt + " < 1"));
  CHECK(page.until("!skinctl.view.finger.visible"));
  CHECK(page.until("document.getElementById('state').textContent === 'at rest'"));
  // By keys: arrows bring the aim there, space presses as long as it is down.
  const auto key = [&](const char* type, const char* name) {
    page.evaluate("document.getElementById('robot').dispatchEvent(new KeyboardEvent('" + std::string(type) +
                  "', {key: '" + name + "', bubbles: true}))");
  };
  page.evaluate("document.getElementById('robot').focus()");
  const auto aim = spot();
  for (double at = 0; at < std::abs(aim[2]); at += 0.02)
    key("keydown", aim[2] > 0 ? "ArrowRight" : "ArrowLeft");
  for (double at = 0; at < std::abs(aim[3]); at += 0.02) key("keydown", aim[3] > 0 ? "ArrowUp" : "ArrowDown");
  key("keydown", " ");
  CHECK(page.until(felt + " > 5"));
  key("keyup", " ");
  CHECK(page.until(felt + " < 1"));
  page.window(360, 1500);
  CHECK(page.evaluate("document.documentElement.scrollWidth <= innerWidth") == true);
  page.window(1400, 1000);
  // The page may go at any time, and takes its finger along.
  const auto last = spot();
  page.mouse("mousePressed", last[0], last[1]);
  CHECK(page.until(felt + " > 5"));
  page.go("about:blank");
  page.go(url);
  CHECK(page.until("skinctl.timeline.list('/skin/contacts').length > 10 && " + felt + " < 1"));
  CHECK(page.errors() == "");
  CHECK(job.end(SIGINT) == 130);
}

int main(int argc, char** argv) {
  doctest::Context context(argc, argv);
  for (int i = 1; i + 1 < argc; ++i)
    if (argv[i] == std::string("--keep")) keep = argv[i + 1];
  chromium = browser::find();
  if (chromium.empty()) {
    std::printf("skipped: no Chromium; nobody pressed the arm\n");
    return skipped;
  }
  return context.run();
}
