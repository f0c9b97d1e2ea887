// Looks at the live page and the placing page in headless Chromium, on a run that goes on: what is drawn,
// stop, resume, scrubbing, a cut file, a patch laid by hand; at the width of a phone nothing overflows; no
// error of a script. Ends with 77 (ctest: skipped) without Chromium. `--keep FOLDER` leaves screenshots
// behind; `--serve` serves until it is interrupted, for people.
//
// Promise: a patch that is laid onto a link by hand is skin that the main job feels
// Tried: every cell to within 1e-12 m of the tube, dragged by mouse and keys; the file that the button
// saves, pressed on one of its cells

#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "examples/live_page/page.hpp"
#include "examples/live_page/tests/simulated_run.hpp"
#include "examples/support/devtools.hpp"
#include "examples/support/run_program.hpp"
#include "skinctl/recording/mcap_recorder.hpp"

using namespace skinctl;
using namespace live_page;
namespace browser = examples::browser;

namespace {

constexpr int skipped = 77;
std::string chromium;
std::filesystem::path keep;

/// Elements beyond the window's width, and buttons that a finger misses.
constexpr char overflow[] = R"js((() => {
  const out = [];
  for (const e of document.body.querySelectorAll('*')) {
    if (!e.getClientRects().length || e.closest('.file')) continue;
    const r = e.getBoundingClientRect();
    if (r.left < -0.5 || r.right > innerWidth + 0.5) out.push(`outside: ${e.tagName} ${e.id}`);
    if (e.tagName === 'BUTTON' && r.height < 43) out.push(`small: ${e.id}`);
  }
  if (document.documentElement.scrollWidth > innerWidth) out.push('the page scrolls sideways');
  return out.join('; ');
})())js";
/// The number of painted points of a chart.
std::string painted(const char* chart) {
  return "(() => { const k = document.getElementById('" + std::string(chart) +
         "'), p = k.getContext('2d').getImageData(0, 0, k.width, k.height).data; let n = 0; for (let i = 3; "
         "i < p.length; "
         "i += 4) n += p[i] > 0; return n; })()";
}
const std::string last_reasons = "skinctl.timeline.list('/skinctl/status').slice(-1)[0].value.reasons";

/// A server with the pages, and a run behind it.
struct Served {
  explicit Served(bool control, std::map<std::string, adapters::live::PageFile> more = {}) {
    adapters::live::ServerOptions o;
    o.allow_control = control;
    put_page(o);
    for (auto& f : more) o.files.insert(f);
    server = std::make_unique<adapters::live::FoxgloveServer>(std::move(o));
    for (std::size_t k = 0; !felt.whole(); ++k)  // cell 61 feels nothing, every tenth little
      felt.look([](std::size_t i) {
        return i == 60 ? std::pair(std::numeric_limits<double>::infinity(), 0.0)
                       : std::pair(i % 10 == 5 ? 10.0 : 4.0, 0.25);
      });
    view = std::make_unique<adapters::live::LiveView<Scene>>(
        *server, requests, run.description(), std::vector<adapters::live::WeightRange>{{1, 0, 1}}, &felt);
    server->start();
    loop = std::thread([this] {
      CycleThread<Scene> thread({view.get()});
      run.run(1'000'000, std::chrono::milliseconds(8), thread, requests, stop);
      thread.finish();
    });
  }
  ~Served() {
    stop = true;
    loop.join();
  }
  std::atomic<bool> stop{false};
  static std::vector<std::uint32_t> ids() {
    std::vector<std::uint32_t> out(260);
    std::iota(out.begin(), out.end(), 1u);
    return out;
  }
  adapters::live::Requests requests;
  adapters::live::FeltMap felt{ids()};
  SimulatedRun run;
  std::unique_ptr<adapters::live::FoxgloveServer> server;
  std::unique_ptr<adapters::live::LiveView<Scene>> view;
  std::thread loop;
};

/// Four seconds of a run as a file.
std::string recorded(const browser::Folder& folder) {
  const std::string path = (folder.path / "run.mcap").string();
  SimulatedRun run;
  adapters::live::Requests requests;
  const std::atomic<bool> stop{false};
  McapRecorder<Scene> recorder(path, RunIdentity{"test"}, run.description());
  CycleThread<Scene> thread({&recorder});
  run.run(500, {}, thread, requests, stop);
  thread.finish();
  REQUIRE(recorder.finish());
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The smallest difference of two of these colours ("rgb(1, 2, 3)" or "#010203"), CIE76, to normal eyes and
/// to those of the three kinds of dichromats (Machado, Oliveira, Fernandes, "A physiologically-based model
/// for simulation of color vision deficiency", 2009, severity 1). Eyes tell 2.3 apart.
double nearest_colours(const nlohmann::json& colours) {
  constexpr double eyes[4][9] = {
      {1, 0, 0, 0, 1, 0, 0, 0, 1},
      {0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998},
      {0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881},
      {1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900}};
  using Three = std::array<double, 3>;
  const auto linear = [](const std::string& text) {
    Three c{};
    unsigned r = 0, g = 0, b = 0;
    REQUIRE_MESSAGE((std::sscanf(text.c_str(), "#%2x%2x%2x", &r, &g, &b) == 3 ||
                     std::sscanf(text.c_str(), "rgb(%u, %u, %u)", &r, &g, &b) == 3),
                    text);
    const unsigned of[3] = {r, g, b};
    for (std::size_t i = 0; i < 3; ++i) {
      const double x = of[i] / 255.0;
      c[i] = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
    }
    return c;
  };
  const auto lab = [](const Three& c) {
    const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
    const double x = f((0.4124 * c[0] + 0.3576 * c[1] + 0.1805 * c[2]) / 0.9505),
                 y = f(0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]),
                 z = f((0.0193 * c[0] + 0.1192 * c[1] + 0.9505 * c[2]) / 1.089);
    return Three{116 * y - 16, 500 * (x - y), 200 * (y - z)};
  };
  double least = 1e9;
  for (const auto& m : eyes) {
    std::vector<Three> seen;
    for (const std::string text : colours) {
      const Three c = linear(text);
      Three s{};
      for (std::size_t i = 0; i < 3; ++i)
        s[i] = std::clamp(m[3 * i] * c[0] + m[3 * i + 1] * c[1] + m[3 * i + 2] * c[2], 0.0, 1.0);
      seen.push_back(lab(s));
    }
    for (std::size_t a = 0; a < seen.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        least = std::min(
            least, std::hypot(seen[a][0] - seen[b][0], seen[a][1] - seen[b][1], seen[a][2] - seen[b][2]));
  }
  return least;
}

}  // namespace

TEST_CASE(
    "The live page: drawn, stopped, resumed, scrubbed, replayed, on a phone and on a desk, in light and "
    "dark") {
  const browser::Folder folder;
  Served served(true, {{"/run.mcap", {"application/octet-stream", recorded(folder)}}});
  browser::Page page(chromium, folder);
  for (const auto& view : {std::tuple("phone", 360, 1500, true), std::tuple("dark", 1400, 1000, true),
                           std::tuple("live", 1400, 1000, false)}) {
    const auto [n, width, height, dark] = view;
    const char* name = n;
    CAPTURE(name);
    page.window(width, height, dark);
    page.go(served.server->url());
    REQUIRE(page.until("skinctl.timeline.list('/joint_states').length > 150"));
    REQUIRE(page.until("(skinctl.view && skinctl.view.drawn > 5 && skinctl.layout) || skinctl.no3d"));
    REQUIRE(page.until("skinctl.timeline.list('/skin/contacts').some(c => c.value.count > 0)"));
    CHECK(page.evaluate("skinctl.errors") == 0);
    CHECK(page.evaluate(overflow) == "");
    for (const char* chart : {"torque", "joints", "force", "time"})
      CHECK(page.evaluate(painted(chart)) > 300);
    if (page.evaluate("!!skinctl.no3d") == true) {
      MESSAGE("no picture of the robot: " << page.evaluate("skinctl.no3d").dump());
    } else {
      CHECK(page.evaluate("skinctl.view.cells.length") == 260);
      CHECK(page.evaluate("skinctl.view.renderer.info.programs.every(p => !p.diagnostics)") == true);
    }
    CHECK(nearest_colours(
              page.evaluate("[0, 1, 2, 3, 4, 5, 6].map(k => getComputedStyle(document.documentElement)"
                            ".getPropertyValue('--c' + k).trim())")) > 12);
    CHECK(
        nearest_colours(page.evaluate("['rest', 'cell', 'near', 'stale', 'arrow'].map(k => getComputedStyle("
                                      "document.querySelector('#view .key.' + k)).backgroundColor)")) > 12);
    if (!keep.empty()) page.picture(keep / (std::string(name) + ".png"));
  }
  // What a frame costs: this page's own work, and 10 000 cells drawn by the computer's processor.
  MESSAGE("own work of a frame with 260 cells [ms], median and p99: " << page.evaluate(
              "(w => [w[w.length >> 1], w[Math.floor(0.99 * w.length)]].map(t => t.toFixed(1)).join(', '))"
              "([...skinctl.work].sort((a, b) => a - b))"));
  if (page.evaluate("!!skinctl.no3d") == false) {
    const auto drawn = page.evaluate(R"js((async () => {
      const v = skinctl.view, own = [], whole = [], gl = v.renderer.getContext();
      const before = v.drawn, from = performance.now();
      await new Promise(done => setTimeout(done, 2000));
      const fps = 1e3 * (v.drawn - before) / (performance.now() - from), layout = skinctl.layout, cells = [];
      for (let i = 0; i < 10000; ++i)
        cells.push({id: 1 + i, X_RootCell: {p: [-0.4 * (i % 400) / 400, 0.06 * Math.sin(i), 0.06 * Math.cos(i)], q: [0, 0, 0, 1]}});
      v.layout({patches: [{name: 'many', link: 'forearm_link', X_LinkRoot: {p: [0, 0, 0], q: [0, 0, 0, 1]}, cells}]});
      const cloud = {view: new DataView(new ArrayBuffer(160000)), step: 16, fields: {force: 0, proximity: 4, cell: 8, status: 12}, count: 10000};
      for (let i = 0; i < 10000; ++i) cloud.view.setUint32(16 * i + 8, 1 + i, true);
      for (let k = 0; k < 20; ++k) {
        const t = performance.now();
        v.readings(cloud);
        v.draw('#fff');
        own.push(performance.now() - t);
        gl.finish();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
        whole.push(performance.now() - t);
      }
      const calls = v.renderer.info.render.calls;
      v.layout(layout);
      skinctl.drawn_cells = null;
      const median = l => l.sort((a, b) => a - b)[l.length >> 1].toFixed(1);
      return `${fps.toFixed(0)} frames a second with 260 cells; 10 000 cells: own work ${median(own)} ms, drawn in software ${median(whole)} ms, ${calls} draw calls`;
    })())js");
    MESSAGE(drawn.get<std::string>());
    CHECK(page.evaluate("skinctl.view.cells.length") == 260);
  }
  // A state in a word, its age, and the values under the pointer.
  const std::string said = "document.getElementById('state').textContent";
  CHECK(page.until("['moving', 'at rest', 'giving way', 'waiting'].includes(" + said + ")"));
  CHECK(page.until("/^\\d+ ms old$/.test(document.getElementById('age').textContent)"));
  CHECK(page.evaluate("document.body.classList.contains('old')") == false);
  const auto inked = [&] { return page.evaluate(painted("joints")).get<int>(); };
  page.evaluate("(() => { const k = document.getElementById('joints'); k.hover = k.clientWidth / 2; })()");
  ::usleep(200'000);
  CHECK(page.evaluate("document.getElementById('joints').hover") != nullptr);
  CHECK(inked() > 100);
  // Stop is obeyed at once, resume asks.
  page.evaluate("document.getElementById('stop').click()");
  CHECK(page.until(last_reasons + ".includes('stopping')"));
  CHECK(page.until(said + " === 'stopped'"));
  CHECK(page.evaluate(painted("events")).get<int>() > 50);
  CHECK(page.until("/stop/.test(document.getElementById('reasons').textContent)"));
  page.key("r");
  CHECK(page.evaluate("document.getElementById('ask').open") == true);
  page.evaluate("document.querySelector('#ask button[value=no]').click()");
  ::usleep(400'000);
  CHECK(page.evaluate(last_reasons + ".includes('stopping')") == true);
  page.evaluate("document.getElementById('resume').click()");
  page.evaluate("document.querySelector('#ask button[value=yes]').click()");
  CHECK(page.until("!" + last_reasons + ".includes('stopping')"));
  // A slider of a weight: asks; without consent it goes back, with it the law's share of the torque fades.
  const auto slide = [&](double to, const char* answer) {
    page.evaluate("(() => { const s = document.getElementById('p-weight of skin joint'); s.value = " +
                  std::to_string(to) +
                  "; s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change')); })()");
    CHECK(page.evaluate("document.getElementById('ask').open && "
                        "/weight of skin joint/.test(document.getElementById('question').textContent)") ==
          true);
    page.evaluate("document.querySelector('#ask button[value=" + std::string(answer) + "]').click()");
  };
  const std::string known = "Number(document.getElementById('p-weight of skin joint').value)";
  CHECK(page.evaluate("document.querySelectorAll('#weights input').length") == 1);  // gravity has none
  slide(0.5, "no");
  CHECK(page.until("!document.getElementById('map').hidden"));
  CHECK(page.evaluate("document.getElementById('map-words').textContent") ==
        "260 places: 1 feel nothing (cells 61), 26 feel little; the slowest may lead at 0.00 m/s.");
  CHECK(page.evaluate("document.getElementById('map-legend').hidden") == true);
  page.evaluate("document.getElementById('map-on').click()");
  CHECK(page.evaluate("document.getElementById('map-legend').hidden") == false);
  if (page.evaluate("!!skinctl.no3d") == false)
    CHECK(
        page.evaluate("[59, 60, 65].map(i => skinctl.view.values[4 * skinctl.view.index.get(i + 1) + 3])") ==
        nlohmann::json({1, 4, 2}));
  page.evaluate("document.getElementById('map-on').click()");
  CHECK(page.until(known + " === 1"));
  const std::string share =
      "(l => Math.max(...l.map(e => Math.max(...e.value.data.slice(0, 6).map(Math.abs)))))"
      "(skinctl.timeline.list('/skinctl/torque_shares').slice(-250))";  // two seconds: somebody presses always
  CHECK(page.until(share + " > 0.02"));
  slide(0, "yes");
  CHECK(page.until(share + " === 0"));
  CHECK(page.evaluate(known) == 0);
  slide(1, "yes");
  CHECK(page.until(share + " > 0.02"));
  // Both ends of a range can be reached, also where it begins at 0.1.
  page.evaluate(
      "skinctl.stream.facts['range of tried'] = '[0.1,1]', skinctl.stream.on.parameters([{name: 'tried', "
      "value: 0.5}])");
  CHECK(
      page.evaluate(
          "(() => { const s = document.getElementById('p-tried'); s.value = 1; const most = Number(s.value); "
          "s.value = 0.1; return [most, Number(s.value)].join(); })()") == "1,0.1");
  page.evaluate("document.getElementById('p-tried').parentElement.remove()");
  // One second back the page stays there while the run goes on.
  page.evaluate(
      "(() => { const s = document.getElementById('scrub'); s.value = -1; s.dispatchEvent(new "
      "Event('input')); })()");
  const double at = page.evaluate("skinctl.at");
  CHECK(page.until("skinctl.timeline.last > " + std::to_string(at) + " + 1.5"));
  CHECK(page.evaluate("skinctl.at") == at);
  CHECK(page.until("!skinctl.live && document.getElementById('when').textContent.startsWith('-')"));
  page.key("l");
  CHECK(page.until("skinctl.live"));
  // A file, whole, cut inside a chunk, and rubbish.
  const auto opened = [&](const std::string& part) {
    page.evaluate("fetch('/run.mcap').then(r => r.arrayBuffer()).then(b => skinctl.open(new File([" + part +
                  "], 'run.mcap')))");
    MESSAGE(page.evaluate("document.getElementById('link').textContent").dump());
    return page.evaluate("skinctl.timeline.list('/joint_states').length").get<int>();
  };
  CHECK(opened("b") == 500);
  const int cut = opened("b.slice(0, Math.floor(0.7 * b.byteLength))");
  CHECK(cut > 50);
  CHECK(cut < 500);
  CHECK(opened("new ArrayBuffer(400)") == 0);
  // Played at five times its pace, to its end.
  CHECK(opened("b") == 500);
  page.evaluate(
      "(() => { document.getElementById('speed').value = '5'; document.getElementById('play').click(); })()");
  CHECK(page.until(
      "skinctl.playing && skinctl.at > skinctl.timeline.first && skinctl.at < skinctl.timeline.last"));
  CHECK(page.until("!skinctl.playing && skinctl.at === skinctl.timeline.last"));
  CHECK(page.errors() == "");
}

TEST_CASE("The live page: a robot whose file has no shapes is drawn from joint to joint") {
  const browser::Folder folder;
  Served served(false);
  browser::Page page(chromium, folder);
  page.go(served.server->url());
  const auto drawn = page.evaluate(R"js((async () => {
    const {shapesOf, onKnown} = await import('./robot.js');
    const joint = (parent, child, xyz) => `<joint type="revolute"><parent link="${parent}"/><child link="${child}"/><origin xyz="${xyz}"/></joint>`;
    const link = (name, inside = '') => `<link name="${name}">${inside}</link>`;
    const mesh = '<visual><geometry><mesh filename="arm.stl"/></geometry></visual>';
    const sphere = '<visual><geometry><sphere radius="0.1"/></geometry></visual>';
    const arm = inside => '<robot>' + link('base') + link('upper', inside) + link('hand') + joint('base', 'upper', '0 0 0.4') + joint('upper', 'hand', '0.3 0 0') + '</robot>';
    const of = inside => onKnown(shapesOf(arm(inside)), new Set(['base', 'upper', 'hand']));
    return [of(''), of(mesh), of(sphere)].map(l => l.map(s => [s.link, s.kind, s.size[1], ...s.X.p].join(' ')).join('; ')).join(' | ');
  })())js");
  const std::string bones = "base capsule 0.4 0 0 0.2; upper capsule 0.3 0.15 0 0";
  CHECK(drawn == bones + " | " + bones + " | upper sphere 0 0 0 0");
}

TEST_CASE("The live page: data that are old look so, and the end of the job is said in its words") {
  const browser::Folder folder;
  Served served(false);
  browser::Page page(chromium, folder);
  page.window(1000, 800);
  page.go(served.server->url());
  REQUIRE(page.until("skinctl.timeline.list('/skinctl/status').length > 2"));
  page.evaluate("skinctl.view = null");
  const std::string old = "document.body.classList.contains('old')",
                    said = "document.getElementById('state').textContent";
  CHECK(page.until("!" + old));
  served.stop = true;  // the loop sends no more, the server lives
  CHECK(page.until(old + " && " + said + " === 'no data'"));
  CHECK(page.until("/^[1-9]\\d* s old$/.test(document.getElementById('age').textContent)"));
  served.server->stop("the skin has fallen silent");
  CHECK(page.until(said + " === 'ended: the skin has fallen silent'"));
  CHECK(page.evaluate(old) == true);
}

TEST_CASE("The live page: a recording that the server has is opened by its address, and played") {
  const browser::Folder folder;
  Served served(false, {{"/recording.mcap", {"application/octet-stream", recorded(folder)}}});
  browser::Page page(chromium, folder);
  page.window(1000, 800);
  page.go(served.server->url() + "?file=recording.mcap");
  CHECK(
      page.until("skinctl.file === 'recording.mcap' && skinctl.timeline.list('/joint_states').length > 100"));
  CHECK(page.evaluate("skinctl.stream === undefined") == true);
  CHECK(page.evaluate("document.getElementById('stop').disabled") == true);
  page.evaluate("document.getElementById('play').click()");
  CHECK(page.until("skinctl.playing"));
}

TEST_CASE("The live page: answers to Stop and Resume stay, and key S stops whatever has the focus") {
  const browser::Folder folder;
  Served served(true);
  browser::Page page(chromium, folder);
  page.window(1000, 800);
  page.go(served.server->url());
  REQUIRE(page.until("skinctl.timeline.list('/skinctl/status').length > 2"));
  REQUIRE(page.until("document.querySelector('#weights input') && (skinctl.view || skinctl.no3d)"));
  page.evaluate(
      "skinctl.view = null");  // no picture is looked at, and drawn in software it takes all of a busy machine
  const std::string stopping = last_reasons + ".includes('stopping')", moving = "!" + stopping;
  const auto answered = [&](const char* to) {
    CAPTURE(to);
    const std::string field = "document.getElementById('answer')";
    REQUIRE(page.until(field + " && / " + to + ": (?!no answer)/.test(" + field + ".textContent)"));
    const std::string words = page.evaluate(field + ".textContent");
    // Ten states a second come meanwhile.
    const int states = page.evaluate("skinctl.timeline.list('/skinctl/status').length");
    REQUIRE(page.until("skinctl.timeline.list('/skinctl/status').length > " + std::to_string(states + 15)));
    CHECK(page.evaluate(field + ".textContent") == words);
    CHECK(page.evaluate("document.getElementById('reasons').textContent.includes('answer')") == false);
  };
  const auto resumed = [&] {
    page.evaluate("skinctl.stream.call('/skinctl/resume')");
    CHECK(page.until(moving));
  };
  page.evaluate("document.getElementById('stop').click()");
  CHECK(page.until(stopping));
  answered("Stop");
  page.evaluate("document.getElementById('resume').click()");
  page.evaluate("document.querySelector('#ask button[value=yes]').click()");
  CHECK(page.until(moving));
  answered("Resume");

  page.evaluate(
      "document.querySelector('main').append(Object.assign(document.createElement('input'), {id: 'words'}))");
  page.evaluate(
      "for (const e of document.querySelectorAll('canvas, input')) e.addEventListener('keydown', k => "
      "k.stopPropagation())");
  for (const std::string selector :
       {"#stop", "#resume", "#live", "a", "#scrub", "#file", "#weights input", "#robot", "#words"}) {
    CAPTURE(selector);
    const std::string element = "document.querySelector('" + selector + "')";
    if (page.evaluate(element + ".hidden") == true) continue;  // no picture of the robot here
    page.evaluate(element + ".focus()");
    CHECK(page.evaluate("document.activeElement === " + element) == true);
    page.key(selector == "#words" ? "S" : "s");
    CHECK(page.until(stopping));
    resumed();
  }
  // Not even a question stands in its way, and it is answered with no.
  page.evaluate("document.getElementById('resume').click()");
  CHECK(page.evaluate("document.getElementById('ask').open") == true);
  page.key("s");
  CHECK(page.until(stopping));
  CHECK(page.evaluate("document.getElementById('ask').open") == false);
  ::usleep(400'000);
  CHECK(page.evaluate(stopping) == true);
  CHECK(page.evaluate(overflow) == "");
  CHECK(page.errors() == "");
}

TEST_CASE("The live page: without consent of the server nothing is controlled but the stop") {
  const browser::Folder folder;
  Served served(false);
  browser::Page page(chromium, folder);
  page.window(1000, 800);
  page.go(served.server->url());
  REQUIRE(page.until("skinctl.timeline.list('/skinctl/status').length > 2"));
  CHECK(page.evaluate("document.getElementById('resume').disabled") == true);
  CHECK(page.evaluate("skinctl.stream.call('/skinctl/resume').then(a => a.done)") == false);
  page.key("s");
  CHECK(page.until(last_reasons + ".includes('stopping')"));
  CHECK(page.errors() == "");
}

TEST_CASE("The placing page: a patch is dragged onto a link, laid onto its tube, and saved as a skin file") {
  const browser::Folder folder;
  Served served(true);
  browser::Page page(chromium, folder);
  for (const auto& [width, height] : {std::pair(360, 1200), std::pair(1400, 900)}) {
    page.window(width, height);
    page.go(served.server->url() + "place.html");
    REQUIRE(page.until(
        "skinctl.laid && ((skinctl.view && skinctl.handle) || !document.getElementById('no3d').hidden)"));
    CHECK(page.evaluate(overflow) == "");
    // Over the middle of the forearm, as by hand.
    page.evaluate(R"js(import('/skin.js').then(({compose, plus, rotate}) => {
      const X = skinctl.frames.get('forearm_link'), t = skinctl.tubes.get('forearm_link');
      const m = t.from.map((v, i) => 0.5 * (v + t.to[i]));
      skinctl.moveTo({p: plus(plus(X.p, rotate(X.q, m)), [0, -0.03, 0.06]), q: X.q});
    }))js");
    CHECK(page.evaluate("skinctl.laid.link") == "forearm_link");
    const double off = page.evaluate(
        R"js(Promise.all([import('/skin.js'), import('/surface.js')]).then(([{minus, size}, {nearest}]) =>
      Math.max(...skinctl.laid.cells.map(c => size(minus(nearest(skinctl.tubes.get('forearm_link'), c.X.p).p, c.X.p))))))js");
    CHECK(off < 1e-12);
    const std::string before = page.evaluate("JSON.stringify(skinctl.laid.root.p)");
    page.key("ArrowLeft");
    CHECK(page.until("JSON.stringify(skinctl.laid.root.p) != '" + before + "'", 5));
    if (!keep.empty() && width > 1000) ::usleep(500'000), page.picture(keep / "place.png");
    // The library takes the file; neighbours keep their distance but for the bend of the tube.
    const SkinFile file =
        parse_skin_file(page.evaluate("JSON.stringify(skinctl.skin())").get<std::string>(), "placed");
    REQUIRE(file.patches.size() == 1);
    REQUIRE(file.patches[0].cells.size() == 20);
    CHECK(file.patches[0].link == "forearm_link");
    double low = 1, high = 0;
    const auto& cells = file.patches[0].cells;
    for (const auto& [a, b] :
         {std::pair(0, 1), std::pair(1, 2), std::pair(6, 7), std::pair(0, 5), std::pair(12, 17)}) {
      const Xyz<double> way = cells[std::size_t(a)].X_RootCell.p - cells[std::size_t(b)].X_RootCell.p;
      const double d = std::sqrt(dot(way, way));
      low = std::min(low, d), high = std::max(high, d);
    }
    MESSAGE("neighbours " << 1e3 * low << " to " << 1e3 * high << " mm apart, of 27.8");
    CHECK(low > 0.024);
    CHECK(high < 0.0285);
  }
#ifdef MAIN_JOB
  // Saved by its button, the file is taken by the main job, whose arm gives way where the patch is pressed.
  page.downloads(folder.path);
  page.evaluate("document.getElementById('save').click()");
  const auto saved = folder.path / "skin.json";
  for (int k = 0; k < 100 && !std::filesystem::exists(saved); ++k) ::usleep(50'000);
  REQUIRE(std::filesystem::exists(saved));
  const auto press = folder.path / "press.toml", told = folder.path / "told.json";
  std::ofstream(press)
      << "[run]\nduration = 6\n[control]\nforce_threshold = 0.02\n[[touch]]\nname = \"finger\"\ncell = 268\n"
         "start = 1\nstiffness = 3000\ndamping = 20\napproach_speed = 0.06\ntravel = 0.06\nhold = 0.6\n";
  const std::string said =
      examples::run_program(MAIN_JOB,
                            "--no-compare --report '' --skin " + saved.string() + " --scenario " +
                                press.string() + " --json " + told.string(),
                            0);
  CHECK_MESSAGE(said.find("20 of 20") != std::string::npos, said);
  std::ifstream in(told);
  const auto touches = nlohmann::json::parse(in)["touches"];
  REQUIRE_MESSAGE(touches.size() == 1, said);
  CHECK(touches[0]["cell"] == 268);
  CHECK(touches[0]["deflection"].get<double>() > 0.01);
#endif
  // A thousand rows are twenty, and it says so.
  const std::string where = "document.getElementById('where').textContent";
  const auto type = [&](const char* id, const char* value) {
    page.evaluate("(() => { const e = document.getElementById('" + std::string(id) + "'); e.value = '" +
                  value + "'; e.dispatchEvent(new Event('input')); })()");
  };
  type("rows", "1000");
  CHECK(page.evaluate("skinctl.laid.cells.length") == 100);
  CHECK(page.evaluate(where + ".includes('rows: 1 to 20, counts as 20')") == true);
  type("rows", "4");
  CHECK(page.evaluate(where) == "on forearm_link");
  // Kept, and laid on top of itself with its ids: questioned before it is saved; taken back step by step.
  const std::string at = page.evaluate("JSON.stringify(skinctl.pose)"),
                    first = page.evaluate("document.getElementById('first').value");
  page.evaluate("document.getElementById('add').click()");
  CHECK(page.until("skinctl.kept.length === 1 && skinctl.before.length > 0"));
  page.evaluate("skinctl.moveTo(" + at + ")");
  CHECK(page.evaluate(where + ".includes('20 of its cells lie on those of patch 1')") == true);
  type("first", first.c_str());
  CHECK(page.evaluate(where + ".includes('20 of its ids are those of patch 1')") == true);
  page.evaluate("document.getElementById('save').click()");
  CHECK(page.until("document.getElementById('ask').open"));
  page.evaluate("document.querySelector('#ask button[value=no]').click()");
  CHECK(page.until("!document.getElementById('ask').open"));
  page.evaluate("document.getElementById('undo').click()");
  CHECK(page.evaluate("skinctl.kept.length") == 0);
  CHECK(page.evaluate("JSON.stringify(skinctl.pose)") == at);
  CHECK(page.evaluate(where) == "on forearm_link");
  // Dragged by the mouse: by one of the three arrows.
  if (page.evaluate("!!(skinctl.view && skinctl.handle)") == true) {
    const std::string before = page.evaluate("JSON.stringify(skinctl.pose.p)");
    bool moved = false;
    for (const char* axis : {"1, 0, 0", "0, 1, 0", "0, 0, 1"}) {
      if (moved) break;
      // Where an arrow's head is on the screen, and its way.
      const auto arrow = page.evaluate(
          std::string(
              "(() => { const T = skinctl.view.THREE, h = skinctl.handle, c = skinctl.view.camera, r = "
              "skinctl.view.canvas.getBoundingClientRect(); const far = h.position.distanceTo("
              "c.position) * Math.tan(c.fov * Math.PI / 360) * 0.7 / 4.2 * 2; const on = s => { const v = "
              "h.localToWorld(new "
              "T.Vector3(") +
          axis +
          ").multiplyScalar(s * far)).project(c); return [r.left + (v.x + 1) / 2 * r.width, "
          "r.top + (1 - v.y) / 2 * r.height]; }; return [on(0.8), on(1.3)]; })()");
      page.mouse("mouseMoved", arrow[0][0], arrow[0][1]);
      ::usleep(100'000);
      page.mouse("mousePressed", arrow[0][0], arrow[0][1]);
      for (const double s : {0.3, 0.6, 1.0}) {
        const double x0 = arrow[0][0], y0 = arrow[0][1], x1 = arrow[1][0], y1 = arrow[1][1];
        page.mouse("mouseMoved", x0 + s * (x1 - x0), y0 + s * (y1 - y0));
        ::usleep(60'000);
      }
      page.mouse("mouseReleased", arrow[1][0], arrow[1][1]);
      moved = page.evaluate("JSON.stringify(skinctl.pose.p)") != before;
    }
    CHECK(moved);
  }
  CHECK(page.errors() == "");
}

int main(int argc, char** argv) {
  doctest::Context context(argc, argv);
  bool serve = false;
  for (int i = 1; i < argc; ++i) {
    if (argv[i] == std::string("--keep") && i + 1 < argc) keep = argv[i + 1];
    serve = serve || argv[i] == std::string("--serve");
  }
  if (serve) {
    Served served(true);
    std::printf("%s\n", served.server->url().c_str());
    std::fflush(stdout);
    served.loop.join();
    return 0;
  }
  chromium = browser::find();
  if (chromium.empty()) {
    std::printf("skipped: no Chromium; the live page was not looked at\n");
    return skipped;
  }
  return context.run();
}
