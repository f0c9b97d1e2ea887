// Presses the arm of the playground's page in headless Chromium, from its file: the pointer, keys, a finger
// on a screen; how far it gives way, how much harder the rigid arm is pressed, switches, sliders, no error of
// a script. Prints what the page weighs and how long it takes. Ends with 77 (ctest: skipped) without
// Chromium. `--keep FOLDER` leaves screenshots behind.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <tuple>

#include "examples/support/devtools.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/model/topology.hpp"

namespace browser = examples::browser;

namespace {

constexpr int skipped = 77;
const std::string file = PLAYGROUND_PAGE, url = "file://" + file;
std::string chromium;
std::filesystem::path keep;

/// Where a cell is on the page [pixels]; one of the forearm that faces the camera.
struct Spot {
  double x = 0, y = 0;
};
Spot spot(browser::Page& page, int cell) {
  const auto at =
      page.evaluate("(() => { const a = playground.arm, at = a.project(a.world(" + std::to_string(cell) +
                    ").p), b = a.canvas.getBoundingClientRect(); return [b.left + (0.5 + 0.5 * at.x) * "
                    "b.width, b.top + (0.5 - "
                    "0.5 * at.y) * b.height]; })()");
  return {at[0], at[1]};
}
/// A cell of a link that faces the camera, and that nothing hides.
int seen(browser::Page& page, int link) {
  const auto cell = page.evaluate(
      "(() => { const a = playground.arm, b = a.canvas.getBoundingClientRect(); let best = -1, most = 0.3; "
      "a.cells.forEach((c, i) => { if (c.link !== " +
      std::to_string(link) +
      ") return; const {p, n} = a.world(i), f = n.dot(a.camera.position.clone().sub(p).normalize()), at = "
      "a.project(p), hit = a.pick({clientX: b.left + (0.5 + 0.5 * at.x) * b.width, clientY: b.top + (0.5 - "
      "0.5 * at.y) * "
      "b.height}); if (hit && hit.link === c.link && f > most) best = i, most = f; }); return best; })()");
  REQUIRE(cell >= 0);
  return cell;
}
void open(browser::Page& page, int width = 1280, int height = 860, bool dark = false) {
  page.window(width, height, dark);
  page.go(url);
  REQUIRE_MESSAGE(page.until("playground.ready > 0"), page.evaluate("document.body.innerText").dump());
}
double number(browser::Page& page, const std::string& script) {
  return page.evaluate(script);
}
std::string state(browser::Page& page) {
  return page.evaluate("document.getElementById('state').textContent");
}
/// Elements beyond the window's width, and what a finger misses.
constexpr char overflow[] = R"js((() => {
  const out = [];
  for (const e of document.body.querySelectorAll('*')) {
    if (!e.getClientRects().length || e.closest('.choice input, #felt')) continue;
    const r = e.getBoundingClientRect();
    if (r.left < -0.5 || r.right > innerWidth + 0.5) out.push(`outside: ${e.tagName} ${e.id}`);
    const pressed = e.tagName === 'BUTTON' || (e.parentElement.matches('.choice label') && e.tagName !== 'INPUT');
    if (pressed && r.height < 43) out.push(`small: ${e.tagName} ${e.textContent}`);
  }
  if (document.documentElement.scrollWidth > innerWidth) out.push('the page scrolls sideways');
  return out.join('; ');
})())js";

/// Presses a cell with the pointer until the arm has given way for 1.5 s of its own time.
void press(browser::Page& page, int cell) {
  const Spot at = spot(page, cell);
  page.mouse("mousePressed", at.x, at.y);
  const double from = number(page, "playground.view.time");
  REQUIRE(page.until("playground.view.time > " + std::to_string(from + 1.5), 120));
}
void let_go(browser::Page& page) {
  page.mouse("mouseReleased", 0, 0);
  REQUIRE(page.until("playground.view.touching === 0"));
}

}  // namespace

TEST_CASE("The playground is one file that loads nothing") {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  CHECK(text.str().find("playground_press") != std::string::npos);
  CHECK(text.str().size() < 2'500'000);
  const browser::Folder folder;
  browser::Page page(chromium, folder);
  open(page);
  CHECK(page.evaluate(
            "performance.getEntriesByType('resource').filter(r => !r.name.startsWith('data:')).length") == 0);
  std::printf("the page: %zu bytes; its module: %ju\n", text.str().size(),
              static_cast<std::uintmax_t>(std::filesystem::file_size(
                  std::filesystem::path(file).replace_filename("playground.wasm"))));
}

TEST_CASE(
    "The playground: pressed by the pointer the arm gives way, the rigid one is pressed harder, and it goes "
    "back") {
  const browser::Folder folder;
  browser::Page page(chromium, folder);
  for (const auto& view : {std::tuple("desk", 1280, 860, false), std::tuple("dark", 1280, 860, true),
                           std::tuple("phone", 390, 844, false)}) {
    const auto [n, width, height, dark] = view;
    const std::string name = n;
    CAPTURE(name);
    open(page, width, height, dark);
    CHECK(page.evaluate(overflow) == "");
    const int cell = seen(page, 2);
    press(page, cell);
    const double force = number(page, "playground.view.force"), peak = number(page, "playground.view.peak");
    const double rigid = number(page, "playground.view.rigid_peak");
    CHECK(force > 1);
    CHECK(peak > 20);
    CHECK(rigid > 1.5 * peak);
    CHECK(number(page, "playground.view.gave_way") > 20);
    CHECK(number(page, "playground.view.reading[" + std::to_string(cell) + "]") > 0.5);
    CHECK(state(page).starts_with("Gives way by "));
    CHECK(page.evaluate("document.getElementById('rigid-force').textContent")
              .get<std::string>()
              .ends_with(" N"));
    if (!keep.empty()) page.picture(keep / ("playground_" + name + ".png"));
    let_go(page);
    CHECK(
        page.until("playground.view.away < 0.02 && /place [12] of its "
                   "task/.test(document.getElementById('state').textContent)"));
    CHECK(page.evaluate("playground.errors.join()") == "");
    MESSAGE(name << ": pressed with " << peak << " N, the rigid arm with " << rigid << " N; ready after "
                 << number(page, "playground.ready") << " ms");
  }
  CHECK(page.until("playground.last_cost > 0"));
  MESSAGE("a cycle of both arms: " << number(page, "playground.last_cost") << " ms of its "
                                   << 1e3 * number(page, "playground.view.period"));
  CHECK(page.errors() == "");
}

TEST_CASE("The playground's switches: every sense by every interface presses; rigid does not give way") {
  const browser::Folder folder;
  browser::Page page(chromium, folder);
  open(page);
  const auto choose = [&](const char* group, int value) {
    page.evaluate("document.querySelectorAll('#" + std::string(group) + " input')[" + std::to_string(value) +
                  "].click()");
  };
  for (int feeling = 0; feeling < 4; ++feeling)
    for (int interface = 0; interface < 3; ++interface) {
      CAPTURE(feeling);
      CAPTURE(interface);
      choose("feeling", feeling);
      choose("interface", interface);
      if (interface == 2 && feeling > 1) {  // it feels by its skin
        CHECK(page.evaluate("document.querySelectorAll('#interface input')[2].disabled") == true);
        CHECK(page.evaluate("playground.state.interface") != 2);
        continue;
      }
      CHECK(page.evaluate("playground.refused") == "");
      REQUIRE(page.until("playground.view.time > 1"));  // the skin has found its rest
      press(page, seen(page, feeling == 2 ? 5 : 2));
      const double peak = number(page, "playground.view.peak"),
                   rigid = number(page, "playground.view.rigid_peak");
      CHECK(rigid > 20);
      if (feeling == 0) CHECK(peak == doctest::Approx(rigid).epsilon(0.2));
      // Beyond their friction motors feel late, so that the peak is almost that of the rigid arm.
      if (feeling == 1 || feeling == 2) CHECK(rigid > 1.5 * peak);
      if (feeling == 3)
        CHECK(number(page, "playground.view.rigid_force") > 1.3 * number(page, "playground.view.force"));
      if (feeling > 0) CHECK(number(page, "playground.view.gave_way") > 10);
      MESSAGE("sense " << feeling << ", interface " << interface << ": " << peak << " N, rigid " << rigid
                       << " N, " << number(page, "playground.last_cost") << " ms a cycle");
      let_go(page);
    }
  CHECK(page.errors() == "");
  CHECK(page.evaluate("playground.errors.join()") == "");
}

TEST_CASE(
    "The playground's sliders: felt mass, a lag that was not measured, what is refused; its skin is hurt") {
  const browser::Folder folder;
  browser::Page page(chromium, folder);
  open(page);
  const auto slide = [&](const char* name, double value) {
    page.evaluate("(() => { const s = document.getElementById('s-" + std::string(name) +
                  "'); s.value = " + std::to_string(value) +
                  "; s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change')); })()");
  };
  const double light = number(page, "playground.view.felt_mass");
  slide("felt_mass", 30);
  CHECK(number(page, "playground.view.felt_mass") == doctest::Approx(30).epsilon(0.02));
  slide("felt_mass", 0);
  CHECK(number(page, "playground.view.felt_mass") == doctest::Approx(light));
  slide("declared_lag", 40);
  CHECK(number(page, "playground.view.felt_mass") > 1.2 * light);  // a later arm has to be felt heavier
  slide("declared_lag", 8);
  slide("real_lag", 70);
  press(page, seen(page, 2));
  CHECK(page.until("playground.view.ended === 1"));
  CHECK(state(page) == "Stopped");
  CHECK(page.evaluate("document.getElementById('words').textContent")
            .get<std::string>()
            .find("the arm follows later than declared") != std::string::npos);
  let_go(page);
  slide("real_lag", 8);
  CHECK(number(page, "playground.view.ended") == 0);
  // No page asks for it; what is refused leaves the arm as it was.
  page.evaluate("playground.choose('damping', -1)");
  CHECK(page.evaluate("document.getElementById('words').textContent").is_string());
  CHECK(page.until("document.getElementById('words').textContent.startsWith('refused: damping = -1')"));
  CHECK(page.evaluate("playground.state.damping") == 6);
  page.evaluate("document.getElementById('hurt').click()");
  CHECK(page.until("playground.view.usable < 250"));
  page.evaluate("document.getElementById('hurt').click()");
  CHECK(page.until("playground.view.usable > 255"));
  CHECK(page.errors() == "");
}

TEST_CASE("The playground by keys and by a finger on the screen") {
  const browser::Folder folder;
  browser::Page page(chromium, folder);
  open(page);
  page.evaluate("document.getElementById('arm').focus()");
  page.key("ArrowRight");
  const double first = number(page, "playground.chosen");
  CHECK(first >= 0);
  page.key("ArrowLeft");
  CHECK(number(page, "playground.chosen") >= 0);
  page.evaluate("document.getElementById('arm').dispatchEvent(new KeyboardEvent('keydown', {key: ' '}))");
  CHECK(page.until("playground.view.force > 5"));
  page.evaluate("document.getElementById('arm').dispatchEvent(new KeyboardEvent('keyup', {key: ' '}))");
  CHECK(page.until("playground.view.touching === 0"));
  page.window(390, 844);
  page.evaluate("scrollTo(0, 0)");
  CHECK(page.until("playground.arm.canvas.clientWidth < 390"));
  const Spot at = spot(page, seen(page, 2));
  page.touch("touchStart", at.x, at.y);
  CHECK(page.until("playground.view.force > 5"));
  page.touch("touchEnd", at.x, at.y);
  CHECK(page.until("playground.view.touching === 0"));
  CHECK(page.errors() == "");
}

namespace {

/// Drops a file on the page.
void drop(browser::Page& page, const std::string& text) {
  page.evaluate(
      "(() => { const data = new DataTransfer(); data.items.add(new File([" + nlohmann::json(text).dump() +
      "], 'robot.urdf')); document.body.dispatchEvent(new DragEvent('drop', {dataTransfer: data, bubbles: "
      "true, cancelable: true})); })()");
}
std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  REQUIRE(!text.str().empty());
  return text.str();
}
std::string words(browser::Page& page) {
  return page.evaluate("document.getElementById('own').textContent");
}
/// The largest distance of a joint on the page from where the library's own reader of the file has it [m],
/// and of its axis from that one's direction.
std::array<double, 2> apart(browser::Page& page, const std::string& file,
                            const skinctl::UrdfOptions& options) {
  using namespace skinctl;
  const auto model = calibrated_from<Chain<6>>(read_urdf(file, options));
  JointPosition<6> q;
  std::array<double, 72> links{};
  // Both of one cycle.
  const auto view = page.evaluate("[...playground.view.q, ...playground.view.links]");
  for (std::size_t i = 0; i < 6; ++i) q[i] = view[i];
  for (std::size_t i = 0; i < 72; ++i) links[i] = view[6 + i];
  std::array<double, 2> out{};
  const auto poses = link_poses(model, q);
  const auto look = [&](std::size_t i, const auto& X) {
    const double* at = &links[12 * i];
    const Xyz<double> z = X.axis_z() - Xyz<double>{at[6], at[7], at[8]};
    const Xyz<double> p = X.origin() - Xyz<double>{at[9], at[10], at[11]};
    out = {std::max(out[0], std::sqrt(dot(p, p))), std::max(out[1], std::sqrt(dot(z, z)))};
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (look(I, poses.template get<I>()), ...);
  }(std::make_index_sequence<6>{});
  return out;
}

}  // namespace

TEST_CASE(
    "The playground: a URDF dropped on it is the next arm, where the library has its joints, and gives way") {
  const browser::Folder folder;
  browser::Page page(chromium, folder);
  open(page);
  struct Case {
    const char* file;
    skinctl::UrdfOptions options;
    const char* words;
  };
  for (const Case& c :
       {Case{"fr3.urdf", {.locked = {{"joint3", 0}}}, "locked: joint3"},
        Case{"iiwa14.urdf", {.locked = {{"A3", 0}}}, "locked: A3"}, Case{"arm6.urdf", {}, ""}}) {
    CAPTURE(c.file);
    drop(page, contents(DATA + std::string(c.file)));
    REQUIRE_MESSAGE(page.until("document.getElementById('robot').textContent.includes('\"')"), words(page));
    CHECK(words(page) == c.words);
    const auto [place, axis] = apart(page, DATA + std::string(c.file), c.options);
    CHECK(place < 1e-9);
    CHECK(axis < 1e-9);
    CHECK(page.evaluate("document.querySelectorAll('#interface input')[2].disabled && "
                        "document.querySelectorAll('#feeling input')[2].disabled") == true);
    REQUIRE(page.until("playground.view.time > 1"));
    // Of the links beyond the elbow the one with most cells.
    const int link = page.evaluate(
        "(() => { const n = [0, 0, 0, 0, 0, 0]; playground.core.cells.forEach(c => n[c.link] += c.link > 1 ? "
        "1 : 0); return "
        "n.indexOf(Math.max(...n)); })()");
    press(page, seen(page, link));
    const double peak = number(page, "playground.view.peak"),
                 rigid = number(page, "playground.view.rigid_peak");
    MESSAGE(c.file << ": " << number(page, "playground.view.cells") << " cells, pressed with " << peak
                   << " N, rigid " << rigid << " N, gave way by " << number(page, "playground.view.gave_way")
                   << " mm, " << number(page, "playground.last_cost") << " ms a cycle");
    CHECK(rigid > 1.3 * peak);
    CHECK(number(page, "playground.view.gave_way") > 10);
    if (!keep.empty()) page.picture(keep / ("playground_" + std::string(c.file) + ".png"));
    let_go(page);
  }
  CHECK(page.evaluate(overflow) == "");
  // What is no such arm is refused in words, and the arm stays.
  const std::string good = contents(DATA + std::string("arm6.urdf"));
  const auto without = [&](const std::string& what, const std::string& instead) {
    std::string text = good;
    REQUIRE(text.find(what) != std::string::npos);
    return text.replace(text.find(what), what.size(), instead);
  };
  for (const auto& [text, why] :
       {std::pair{std::string("<robot"), "no XML, or cut off"},
        {std::string("<sdf/>"), "no URDF: its root is <sdf>"},
        {std::string("<robot name='x'/>"), "no joint"},
        {without("type=\"revolute\"", "type=\"fixed\""), "5 joints of its longest arm turn"},
        {without("xyz=\"0 0 1\"", "xyz=\"0 0 0\""), "an axis without direction"},
        {without("xyz=\"0 0 1\"", "xyz=\"0 0 west\""), "three numbers"}}) {
    CAPTURE(text);
    drop(page, text);
    CHECK_MESSAGE(
        page.until("document.getElementById('own').textContent.includes('" + std::string(why) + "')"),
        words(page));
    CHECK(page.evaluate("document.getElementById('robot').textContent").get<std::string>().find("arm6") !=
          std::string::npos);
  }
  page.evaluate("document.getElementById('ur5').click()");
  CHECK(page.until("document.getElementById('robot').textContent.includes('simulated UR5 with 260 cells')"));
  REQUIRE(page.until("playground.view.time > 1"));
  press(page, seen(page, 2));
  CHECK(number(page, "playground.view.gave_way") > 20);
  let_go(page);
  CHECK(page.evaluate("playground.errors.join()") == "");
  CHECK(page.errors() == "");
}

int main(int argc, char** argv) {
  for (int i = 1; i + 1 < argc; ++i)
    if (std::string(argv[i]) == "--keep") keep = std::filesystem::absolute(argv[i + 1]);
  chromium = browser::find();
  if (chromium.empty()) {
    std::fprintf(
        stderr,
        "SKIPPED: no chromium on the path, so nobody has pressed the arm. apt-get install chromium\n");
    return skipped;
  }
  if (!keep.empty()) std::filesystem::create_directories(keep);
  return doctest::Context(argc, argv).run();
}
