// Looks at the report in headless Chromium: plots are there and drawn, nothing goes wrong, nothing is
// fetched, and at the width of a phone no page overflows, no text is cut off, overlapped or too small. Ends
// with 77 (ctest: skipped) where there is no Chromium. `--keep FOLDER` leaves the pages, and screenshots of
// them, behind.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "examples/compliant_ur5/report.hpp"
#include "examples/compliant_ur5/tests/synthetic_log.hpp"
#include "examples/support/browser.hpp"
#include "examples/support/svg_plot.hpp"

using namespace compliant_ur5;
using examples::browser::console;
using examples::browser::Folder;
using examples::browser::Outcome;
namespace fs = std::filesystem;

namespace {

constexpr int skipped = 77;
std::string browser;
fs::path keep;

Outcome browse(const Folder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "--disable-gpu");
  return examples::browser::browse(browser, folder, std::move(arguments));
}

/// What the probe measured in a page of one width.
using Measures = std::map<std::string, double>;

/// Runs in the page around: loads the page in a frame of each width, one after the other, and notes what is
/// seen.
constexpr char probe[] = R"js(
const page = document.getElementById('page').textContent, result = document.getElementById('result');
const notes = document.getElementById('notes');
function look(frame, width) {
  const d = frame.contentDocument, root = d.documentElement, w = frame.contentWindow;
  const seen = e => e.getClientRects().length > 0;
  const plots = [...d.querySelectorAll('figure > svg, .grid svg')].filter(seen);
  const views = [...d.querySelectorAll('.views svg')].filter(seen);
  let curves = 0, empty = 0, smallest = 1e9, cut = 0, overlaps = 0, unstyled = 0;
  for (const svg of [...plots, ...views]) {
    const paths = [...svg.querySelectorAll('.curves path')];
    if (paths.length == 0 && !views.includes(svg)) empty++;
    for (const p of paths) {
      if (p.getTotalLength() > 0) curves++; else empty++;
      if (w.getComputedStyle(p).stroke == 'none') unstyled++;
    }
    const box = svg.getBoundingClientRect(), scale = box.width / svg.viewBox.baseVal.width;
    const texts = [...svg.querySelectorAll('text')].filter(t => t.textContent);
    const boxes = texts.map(t => t.getBoundingClientRect());
    texts.forEach((t, i) => {
      smallest = Math.min(smallest, parseFloat(w.getComputedStyle(t).fontSize) * scale);
      const b = boxes[i];
      if (b.left < box.left - 1 || b.right > box.right + 1 || b.top < box.top - 3 || b.bottom > box.bottom + 3) {
        cut++;
        notes.textContent += `${width}: cut "${t.textContent}"\n`;
      }
      for (let k = 0; k < i; k++) {
        const c = boxes[k], x = Math.min(b.right, c.right) - Math.max(b.left, c.left),
              y = Math.min(b.bottom, c.bottom) - Math.max(b.top, c.top);
        if (x > 1 && y > 5 * scale) {
          overlaps++;
          notes.textContent += `${width}: "${t.textContent}" on "${texts[k].textContent}"\n`;
        }
      }
    });
  }
  let marks = 0, hidden = 0, broken = 0, links = 0;
  for (const svg of views) {
    marks += svg.querySelectorAll('.touch').length;
    for (const p of svg.querySelectorAll('.skin, .body, .edge, .spot, .flag')) {
      const c = w.getComputedStyle(p), paint = p.tagName == 'path' ? c.stroke : c.fill;
      if (paint == 'none' || paint == w.getComputedStyle(svg.closest('section')).backgroundColor && !/flag|behind/.test(p.getAttribute('class'))) hidden++;
    }
  }
  for (const a of d.querySelectorAll('a[download]')) {
    links++;
    const text = decodeURIComponent(a.href.slice(a.href.indexOf(',') + 1)), rows = text.trim().split('\n');
    if (a.href.length > 2e6 || rows.length < 2 || !/^(touch|time \[s\]),/.test(text)) {
      broken++;
      notes.textContent += `${width}: file "${a.download}"\n`;
    }
  }
  // Words are not broken into letters where a line has room for them.
  let split = 0;
  const range = d.createRange();
  const letters = d.createTreeWalker(d.body, NodeFilter.SHOW_TEXT);
  while (letters.nextNode()) {
    const node = letters.currentNode;
    if (node.parentElement.closest('svg') || !seen(node.parentElement)) continue;
    for (const word of node.data.matchAll(/[^\s\u00a0\u2013/-]+/g)) {
      if (word[0].length > 20) continue;
      range.setStart(node, word.index);
      range.setEnd(node, word.index + word[0].length);
      const tops = new Set([...range.getClientRects()].filter(r => r.width > 0).map(r => Math.round(r.top)));
      if (tops.size > 1) {
        split++;
        notes.textContent += `${width}: split "${word[0]}"\n`;
      }
    }
  }
  let words = 1e9, outside = 0;
  const walker = d.createTreeWalker(d.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const e = walker.currentNode.parentElement;
    if (!walker.currentNode.data.trim() || e.closest('svg') || !seen(e)) continue;
    words = Math.min(words, parseFloat(w.getComputedStyle(e).fontSize));
    const r = e.getBoundingClientRect();
    if (!e.closest('.scroll') && (r.left < -0.5 || r.right > width + 0.5)) {
      outside++;
      notes.textContent += `${width}: outside "${e.textContent.slice(0, 40)}"\n`;
    }
  }
  const tables = [...d.querySelectorAll('table')].filter(t => !t.closest('.scroll')).length;
  const fetched = w.performance.getEntriesByType('resource').length;
  const v = {client: root.clientWidth, scroll: root.scrollWidth, plots: plots.length, curves, empty, unstyled, smallest,
    cut, overlaps, words, outside, tables, fetched, headings: d.querySelectorAll('h1').length,
    bands: d.querySelectorAll('.band').length, height: root.scrollHeight, views: views.length, marks, hidden, broken,
    links, split};
  result.textContent += `width ${width}` + Object.entries(v).map(([k, n]) => ` ${k} ${n}`).join('') + '\n';
}
window.onerror = (m) => { notes.textContent += 'error: ' + m + '\n'; };
function next(widths) {
  if (widths.length == 0) { result.textContent += 'done\n'; return; }
  const frame = document.createElement('iframe');
  frame.style = `border:0;height:900px;width:${widths[0]}px`;
  frame.onload = () => {
    try {
      frame.contentDocument.querySelectorAll('details').forEach(e => e.open = true);
      look(frame, widths[0]);
    } catch (e) { notes.textContent += 'error: ' + e + '\n'; }
    frame.remove();
    next(widths.slice(1));
  };
  frame.srcdoc = JSON.parse(page);
  document.body.append(frame);
}
next([320, 360, 412, 640, 641, 768, 1280, 1920]);
)js";

std::string json(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (c == '<')
      out += "\\u003c";
    else if (c == '\n')
      out += "\\n";
    else
      out += c;
  }
  return out + '"';
}

struct Looked {
  std::map<int, Measures> at;  ///< by width
  std::string notes;
};

std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) return {};
  const auto end = text.find(to, at + from.size());
  return end == std::string::npos ? "" : text.substr(at + from.size(), end - at - from.size());
}

Looked look_at(const Folder& folder, const std::string& html) {
  const std::string page = folder.file(
      "probe.html", "<!doctype html><meta charset=utf-8><body><script type=\"text/plain\" id=page>" +
                        json(html) + "</script><pre id=result></pre><pre id=notes></pre><script>" + probe +
                        "</script></body>");
  const Outcome outcome =
      browse(folder, {"--dump-dom", "--virtual-time-budget=20000", "--window-size=2000,1200", page});
  REQUIRE(outcome.code == 0);
  Looked looked;
  looked.notes = between(outcome.out, "<pre id=\"notes\">", "</pre>");
  std::istringstream lines(between(outcome.out, "<pre id=\"result\">", "</pre>"));
  bool done = false;
  for (std::string line; std::getline(lines, line);) {
    if (line == "done") done = true;
    std::istringstream words(line);
    Measures measures;
    std::string name;
    for (double value = 0; words >> name >> value;) measures[name] = value;
    if (measures.count("width") != 0) looked.at[static_cast<int>(measures["width"])] = measures;
  }
  CAPTURE(looked.notes);
  REQUIRE(done);
  return looked;
}

void check_page(const Folder& folder, const RunLog& log, const std::string& name) {
  CAPTURE(name);
  const std::string html = report(log);
  const Looked looked = look_at(folder, html);
  CHECK(looked.notes == "");
  REQUIRE(looked.at.size() == 8);
  for (const auto& [at, m] : looked.at) {
    const int width = at;
    CAPTURE(width);
    CHECK(m.at("client") == width);
    CHECK(m.at("scroll") <= width);
    CHECK(m.at("outside") == 0);
    CHECK(m.at("cut") == 0);
    CHECK(m.at("overlaps") == 0);
    CHECK(m.at("smallest") >= 9);
    CHECK(m.at("words") >= 12);
    CHECK(m.at("tables") == 0);
    CHECK(m.at("fetched") == 0);
    CHECK(m.at("headings") == 1);
    CHECK(m.at("unstyled") == 0);
    // Five figures and the joints' shares; the close-up only when there was a touch.
    const bool close = !log.touches.empty();
    CHECK(m.at("plots") == (close ? 13 : 11));
    if (!log.entries.empty()) {
      CHECK(m.at("curves") == 1 + 6 + 6 + 6 + 3 + 6 * 3 + (close ? 2 : 0));
      CHECK(m.at("empty") == 0);
    }
    CHECK(m.at("split") == 0);
    CHECK(m.at("hidden") == 0);
    CHECK(m.at("broken") == 0);
    CHECK(m.at("links") == (log.entries.empty() ? 0 : close ? 4 : 3));
    CHECK(m.at("views") == (log.entries.empty() ? 0 : 2));
    CHECK(m.at("marks") == 2 * std::min<std::size_t>(log.touches.size(), 24));
    CHECK(m.at("bands") == (close ? 16 * log.touches.size() + 2 : 0));
  }
}

}  // namespace

TEST_CASE("Browser: the report as a file is drawn, without a word on the console") {
  const Folder folder;
  const std::string path = (folder.path / "report.html").string();
  write_report(synthetic_log(), path);
  const Outcome outcome =
      browse(folder, {"--dump-dom", "--enable-logging=stderr", "--window-size=1280,900", "file://" + path});
  CHECK(outcome.code == 0);
  CHECK(console(outcome.err) == "");
  CHECK(outcome.out.find("<h1>") != std::string::npos);
  CHECK(outcome.out.find("<svg class=\"sp wide\"") != std::string::npos);
  CHECK(outcome.out.find("<path class=\"s5\" d=\"M") != std::string::npos);
  if (!keep.empty()) {
    fs::copy_file(path, keep / "report.html", fs::copy_options::overwrite_existing);
    for (const auto& [name, width] : {std::pair{"desktop", 1280}, std::pair{"phone", 390}}) {
      const std::string frame = folder.file(
          "frame.html",
          "<body style=\"margin:0\"><iframe src=report.html style=\"border:0;height:6000px;width:" +
              std::to_string(width) + "px\"></iframe></body>");
      browse(folder, {"--window-size=" + std::to_string(width) + ",6000",
                      "--screenshot=" + (keep / (std::string(name) + ".png")).string(), frame});
      CHECK(fs::exists(keep / (std::string(name) + ".png")));
    }
  }
}

TEST_CASE("Browser: readable from 320 to 1920 px, whatever the run was") {
  const Folder folder;
  check_page(folder, synthetic_log(), "a minute");
  check_page(folder, synthetic_log(9, 125), "nine seconds");
  RunLog many = synthetic_log(400, 20);
  for (LogEntry& e : many.entries) e.force *= 1e4, e.acceleration[5] *= 1e6F;
  check_page(folder, many, "66 touches and large numbers");
  RunLog worded = synthetic_log(20, 125);
  worded.title = std::string(300, 'W') + " a very long title";
  worded.laws = {"a law with a long name that says what it does", "another one", std::string(60, 'M')};
  worded.scenario.push_back({std::string(80, 'n'), std::string(200, 'v')});
  // A short name beside a long text keeps its letters on one line.
  worded.result.push_back(
      {"why",
       "sample stale: the cell does not push; opposed: skin and tracking push against each "
       "other; bumpless transfer: a torque difference is being ramped out"});
  worded.times.push_back({"a stage with a long name", 1e9, 1e9, 1e9, 1e9});
  worded.velocity_limit = {1, 1.1, 1.2, 1.3, 1.4, 1.5};
  check_page(folder, worded, "long words");
  check_page(folder, RunLog{}, "nothing");
}

TEST_CASE("Browser: the picture is an image that is drawn") {
  const Folder folder;
  folder.file("picture.svg", picture(synthetic_log()));
  folder.file("broken.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\"><g></svg>");
  const std::string page =
      folder.file("image.html",
                  "<body><pre id=r></pre><script>const r=document.getElementById('r');for(const n of "
                  "['picture','broken']){const i=new "
                  "Image();i.onload=()=>r.append(` ${n}:${i.naturalWidth}`);i.onerror=()=>r.append(` "
                  "${n}:error`);i.src=n+'.svg'}</script>");
  const Outcome outcome = browse(folder, {"--dump-dom", "--virtual-time-budget=5000", page});
  const std::string said = between(outcome.out, "<pre id=\"r\">", "</pre>");
  CHECK(said.find("picture:880") != std::string::npos);
  CHECK(said.find("broken:error") != std::string::npos);
  if (!keep.empty()) {
    fs::copy_file(folder.path / "picture.svg", keep / "picture.svg", fs::copy_options::overwrite_existing);
    browse(folder, {"--window-size=880,520", "--screenshot=" + (keep / "picture.png").string(),
                    "file://" + (folder.path / "picture.svg").string()});
  }
}

TEST_CASE("Browser: the probe sees what would be wrong") {
  const Folder folder;
  const Looked looked = look_at(
      folder,
      "<!doctype html><style>body{margin:0}</style><h1 style=\"font-size:9px\">small</h1><div "
      "style=\"width:700px\">wide</div>"
      "<table><tr><td>1</table><p style=\"width:8px;overflow-wrap:anywhere\">noted</p><a download=x.csv "
      "href=\"data:text/csv,time\">x</a><section class=views><svg class=arm><path class=skin d=\"M1 "
      "1h9\"/></svg></section><img src=\"file:///nowhere.png\"><figure style=\"margin:0\"><svg viewBox=\"0 "
      "0 100 40\" "
      "width=100><text x=60 y=20 font-size=13>beyond the edge</text><text x=60 y=20 font-size=13>upon</text>"
      "<g "
      "class=curves><path d=\"M1 1\"/></g></svg></figure>");
  const Measures& m = looked.at.at(360);
  CHECK(m.at("scroll") > 360);
  CHECK(m.at("outside") > 0);
  CHECK(m.at("cut") == 1);
  CHECK(m.at("overlaps") == 1);
  CHECK(m.at("words") == 9);
  CHECK(m.at("tables") == 1);
  CHECK(m.at("empty") == 1);
  CHECK(m.at("unstyled") == 1);
  CHECK(m.at("split") == 1);
  CHECK(m.at("broken") == 1);
  CHECK(m.at("hidden") == 1);
  const std::string wrong = folder.file("wrong.html", "<script>undefined_function()</script>");
  CHECK(browse(folder, {"--dump-dom", "--enable-logging=stderr", wrong}).err.find("CONSOLE") !=
        std::string::npos);
}

int main(int argc, char** argv) {
  for (int i = 1; i + 1 < argc; ++i)
    if (std::string(argv[i]) == "--keep") keep = fs::absolute(argv[i + 1]);
  browser = examples::browser::find();
  if (browser.empty()) {
    std::fprintf(
        stderr,
        "SKIPPED: no chromium on the path, so nobody has looked at the report. apt-get install chromium\n");
    return skipped;
  }
  if (!keep.empty()) fs::create_directories(keep);
  return doctest::Context(argc, argv).run();
}
