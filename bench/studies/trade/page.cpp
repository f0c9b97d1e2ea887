#include "bench/studies/trade/page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "bench/studies/trade/csv.hpp"
#include "bench/studies/trade/page_text.hpp"
#include "examples/support/report_style.hpp"

namespace trade {
namespace {

constexpr const char* columns =
    "scene,policy,value,preset,hot_us,cold_us,instructions,code_bytes,memory_bytes,samples,mm,mm_stiff,N,J,"
    "verdict,"
    "evidence,command";

/// The numbers of a row in the order of the columns.
template <class R>
auto numbers(R& r) {
  return std::array{&r.hot,     &r.cold, &r.instructions, &r.code, &r.bytes,
                    &r.samples, &r.mm,   &r.mm_stiff,     &r.N,    &r.J};
}
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}
std::string number(double x, const char* format = "%.5g") {
  if (!(x - x == 0)) return "";
  char text[40];
  std::snprintf(text, sizeof text, format, x);
  return text;
}
std::vector<std::string> scenes_of(const std::vector<Row>& rows) {
  std::vector<std::string> out;
  for (const Row& r : rows)
    if (std::find(out.begin(), out.end(), r.scene) == out.end()) out.push_back(r.scene);
  return out;
}
/// For HTML and inside of its scripts.
std::string json(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (c == '<')
      out += "\\u003c";
    else if (static_cast<unsigned char>(c) < 32)
      out += ' ';
    else
      out += c;
  }
  return out + "\"";
}
std::string json(double x) {
  const std::string text = number(x);
  return text.empty() ? "null" : text;
}
double work(const Row& r) {
  return r.instructions > 0 ? r.instructions : r.hot;
}

}  // namespace

double cost(const Row& row, Clock clock) {
  return clock == Clock::hot ? row.hot : row.cold;
}
double error(const Row& row) {
  return row.mm_stiff > row.mm ? row.mm_stiff : row.mm;
}

void judge(std::vector<Row>& rows) {
  for (Row& r : rows) {
    if (r.policy == "reference") {
      r.verdict = "reference";
      continue;
    }
    double others = 1e300, bytes = 1e300;
    for (const Row& o : rows) {
      if (&o == &r || o.scene != r.scene || o.policy == "reference" || !(error(o) <= error(r) * 1.1 + 1e-9))
        continue;
      if (o.policy == r.policy && o.value == r.value) continue;
      // The same choices under another name are no competitor.
      if (!o.preset.empty() && o.instructions == r.instructions && o.mm == r.mm && o.mm_stiff == r.mm_stiff)
        continue;
      if (!r.preset.empty() && o.instructions == r.instructions && o.mm == r.mm && o.mm_stiff == r.mm_stiff)
        continue;
      others = std::min(others, work(o));
      bytes = std::min(bytes, o.bytes);
    }
    const double saved = others < 1e300 ? 1 - work(r) / others : 1,
                 less = bytes < 1e300 ? 1 - r.bytes / bytes : 0;
    char text[64];
    if (saved >= 0.05 && others < 1e300)
      std::snprintf(text, sizeof text, "real: %.0f %% cheaper", 100 * saved);
    else if (saved >= 0.05)
      std::snprintf(text, sizeof text, "real: nothing is as exact");
    else if (less >= 0.05)
      std::snprintf(text, sizeof text, "real: %.0f %% less memory", 100 * less);
    else
      std::snprintf(text, sizeof text, "no");
    r.verdict = text;
  }
}
bool offered(const Row& row) {
  return !row.preset.empty() || row.verdict.rfind("real", 0) == 0;
}

const Row* within_time(const std::vector<Row>& rows, const std::string& scene, Clock clock, double us) {
  const Row* best = nullptr;
  for (const Row& r : rows)
    if (r.scene == scene && offered(r) && cost(r, clock) <= us)
      if (best == nullptr || error(r) < error(*best) ||
          (error(r) == error(*best) && cost(r, clock) < cost(*best, clock)))
        best = &r;
  return best;
}
const Row* within_error(const std::vector<Row>& rows, const std::string& scene, Clock clock, double mm,
                        double N) {
  const Row* best = nullptr;
  for (const Row& r : rows)
    if (r.scene == scene && offered(r) && error(r) <= mm && !(r.N > N))
      if (best == nullptr || cost(r, clock) < cost(*best, clock)) best = &r;
  return best;
}

void write_csv(const std::vector<Row>& rows, const std::string& file) {
  std::ofstream out(file);
  out << columns << '\n';
  for (const Row& r : rows) {
    out << cell(r.scene) << ',' << cell(r.policy) << ',' << cell(r.value) << ',' << cell(r.preset);
    for (const double* x : numbers(r)) out << ',' << number(*x);
    out << ',' << cell(r.verdict) << ',' << cell(r.evidence) << ',' << cell(r.command) << '\n';
  }
  out.flush();
  if (!out) throw std::runtime_error("cannot write " + file);
}
std::vector<Row> read_csv(const std::string& file) {
  std::vector<Row> rows;
  read_table(file, columns, "skinctl_trade", [&](const auto& words, const std::string& place) {
    Row r{.scene = words[0], .policy = words[1], .value = words[2], .preset = words[3]};
    std::size_t k = 4;
    for (double* x : numbers(r)) *x = number_in(words[k++], *x, place);
    r.verdict = words[14], r.evidence = words[15], r.command = words[16];
    rows.push_back(r);
  });
  return rows;
}

std::string page(const std::vector<Row>& rows, const std::vector<skinctl::bounds::Bracket>& proven) {
  std::string data = "[\n";
  for (const Row& r : rows) {
    data += "{\"scene\":" + json(r.scene) + ",\"policy\":" + json(r.policy) + ",\"value\":" + json(r.value) +
            ",\"preset\":" + json(r.preset) + ",\"hot\":" + json(r.hot) + ",\"cold\":" + json(r.cold) +
            ",\"instructions\":" + json(r.instructions) + ",\"code\":" + json(r.code) +
            ",\"bytes\":" + json(r.bytes) + ",\"samples\":" + json(r.samples) + ",\"mm\":" + json(r.mm) +
            ",\"stiff\":" + json(r.mm_stiff) + ",\"error\":" + json(error(r)) + ",\"N\":" + json(r.N) +
            ",\"J\":" + json(r.J) + ",\"verdict\":" + json(r.verdict) + ",\"evidence\":" + json(r.evidence) +
            ",\"offered\":" + (offered(r) ? "true" : "false") + ",\"command\":" + json(r.command) + "},\n";
  }
  if (!rows.empty()) data.resize(data.size() - 2);
  data += "\n]";
  std::string bounds = "[\n";
  for (const auto& b : proven)
    bounds += "{\"robot\":" + json(b.robot) + ",\"quantity\":" + json(b.quantity) +
              ",\"unit\":" + json(b.unit) + ",\"velocity\":" + json(b.velocity) +
              ",\"acceleration\":" + json(b.acceleration) + ",\"float\":[" + json(b.float_found) + "," +
              json(b.float_proven) + "],\"double\":[" + json(b.double_found) + "," + json(b.double_proven) +
              "]},\n";
  if (!proven.empty()) bounds.resize(bounds.size() - 2);
  bounds += "\n]";
  return std::string(
             "<!doctype html>\n<html lang=en><meta charset=utf-8><meta name=viewport "
             "content=\"width=device-width,initial-scale=1\"><title>skinctl: speed against "
             "accuracy</title>\n<style>") +
         examples::report_style + own_style + "</style>\n" + page_body + "<script>\nconst rows=" + data +
         ",\nproven=" + bounds + ";\n" + page_script + "</script>\n</html>\n";
}
void write_page(const std::vector<Row>& rows, const std::vector<skinctl::bounds::Bracket>& proven,
                const std::string& file) {
  std::ofstream out(file);
  out << page(rows, proven);
  out.flush();
  if (!out) throw std::runtime_error("cannot write " + file);
}

std::string as_markdown(const std::vector<Row>& rows) {
  std::ostringstream out;
  const auto figures = [&](const Row& r) {
    out << " | " << number(r.hot, "%.2f") << " | " << number(r.cold, "%.1f") << " | "
        << number(r.instructions, "%.0f") << " | " << number(r.code / 1024, "%.1f") << " | "
        << number(r.bytes, "%.0f") << " | " << number(r.samples, "%.1f") << " | " << number(r.mm, "%.2g")
        << " | " << number(r.mm_stiff, "%.2g") << " | " << number(r.N, "%.2g") << " | " << number(r.J, "%.2g")
        << " |";
  };
  const char* heads =
      "hot [us] | cold [us] | instructions | code [KB] | memory [B] | samples a cycle | forces given [mm] | "
      "stiff "
      "finger [mm] | force [N] | energy [J] |";
  const std::vector<std::string> scenes = scenes_of(rows);
  out << "| scene | preset | " << heads << "\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& r : rows) {
    if (r.preset.empty()) continue;
    out << "| " << r.scene << " | " << r.preset;
    figures(r);
    out << '\n';
  }
  // All choices of the scene that has most of them.
  std::string widest;
  std::ptrdiff_t most = 0;
  for (const std::string& scene : scenes) {
    const auto n = std::count_if(rows.begin(), rows.end(), [&](const Row& r) { return r.scene == scene; });
    if (n > most) most = n, widest = scene;
  }
  out << "\n"
      << widest << ":\n\n| choice | " << heads
      << " moves the front? |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& r : rows) {
    if (r.scene != widest || !r.preset.empty()) continue;
    out << "| " << r.policy << ": " << r.value;
    figures(r);
    out << " " << r.verdict << " |\n";
  }
  return out.str();
}

namespace {
/// To two digits, upwards.
double rounded_up(double x) {
  const double digit = std::pow(10, std::floor(std::log10(x)) - 1);
  return std::ceil(x / digit * (1 - 1e-12)) * digit;
}
}  // namespace
std::string as_markdown(const std::vector<skinctl::bounds::Bracket>& proven) {
  std::ostringstream out;
  std::vector<std::string> robots, quantities;
  for (const auto& b : proven) {
    if (std::find(robots.begin(), robots.end(), b.robot) == robots.end()) robots.push_back(b.robot);
    if (std::find(quantities.begin(), quantities.end(), b.quantity) == quantities.end())
      quantities.push_back(b.quantity);
  }
  for (const bool in_float : {true, false}) {
    out << "| " << (in_float ? "float" : "double");
    for (const auto& q : quantities)
      for (const auto& b : proven)
        if (b.quantity == q) {
          out << " | " << q << " [" << b.unit << "]";
          break;
        }
    out << " |\n|---";
    for (std::size_t k = 0; k < quantities.size(); ++k) out << "|---";
    out << "|\n";
    for (const auto& robot : robots) {
      out << "| " << robot;
      for (const auto& q : quantities) {
        out << " | ";
        for (const auto& b : proven) {
          if (b.robot != robot || b.quantity != q) continue;
          const double least = in_float ? b.float_found : b.double_found,
                       most = in_float ? b.float_proven : b.double_proven;
          out << "[" << number(least, "%.2g") << ", " << number(rounded_up(most), "%.2g") << "] "
              << number(most / least, "%.1f") << "x";
        }
      }
      out << " |\n";
    }
    if (in_float) out << '\n';
  }
  return out.str();
}

std::string picture(const std::vector<Row>& rows, const std::string& scene) {
  // Logarithmic axes; an error of nothing stands at the lower edge.
  constexpr double W = 720, H = 360, left = 66, right = 16, top = 40, bottom = 46, least = 1e-5;
  double x0 = 1e300, x1 = 0, y0 = least, y1 = least;
  for (const Row& r : rows)
    if (r.scene == scene && r.hot > 0)
      x0 = std::min(x0, r.hot), x1 = std::max({x1, r.hot, r.cold}), y1 = std::max(y1, error(r));
  if (!(x1 > 0)) return "";
  x0 = std::pow(10, std::floor(std::log10(x0) * 4) / 4), x1 = std::pow(10, std::ceil(std::log10(x1) * 4) / 4);
  y1 = std::pow(10, std::ceil(std::log10(y1)));
  const auto X = [&](double x) { return left + (W - left - right) * std::log(x / x0) / std::log(x1 / x0); };
  const auto Y = [&](double y) {
    return H - bottom - (H - top - bottom) * std::log(std::max(y, least) / y0) / std::log(y1 / y0);
  };
  std::ostringstream out;
  out.precision(5);
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << W << ' ' << H
      << "\" font-family=\"sans-serif\" "
         "font-size=\"13\"><style>text{fill:#1f2328}.g{stroke:#d8dee4}.h{fill:#0969da}.c{fill:none;"
         "stroke:#c0262d;stroke-width:1.6}.p{font-weight:600}.l{stroke-width:1.5;fill:none}@media(prefers-"
         "color-scheme:dark){"
         "text{fill:#e6edf3}.g{stroke:#2d3540}.h{fill:#58a6ff}.c{stroke:#ff7b72}}</style>\n";
  out << "<text x=\"" << left << "\" y=\"18\" class=\"p\">" << scene
      << ": error of the tool's path [mm] against the time of a cycle [us]</text>\n";
  for (double y = y0; y < y1 * 1.01; y *= 10)
    out << "<path class=\"g\" d=\"M" << left << ' ' << Y(y) << "H" << W - right
        << "\"/><text text-anchor=\"end\" x=\"" << left - 6 << "\" y=\"" << Y(y) + 4 << "\">" << y
        << "</text>\n";
  for (const double x : {0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0})
    if (x >= x0 && x <= x1)
      out << "<path class=\"g\" d=\"M" << X(x) << ' ' << top << "V" << H - bottom
          << "\"/><text text-anchor=\"middle\" x=\"" << X(x) << "\" y=\"" << H - bottom + 18 << "\">" << x
          << "</text>\n";
  out << "<circle class=\"h\" cx=\"" << left + 8 << "\" cy=\"" << H - 11 << "\" r=\"4\"/><text x=\""
      << left + 18 << "\" y=\"" << H - 7 << "\">hot</text><circle class=\"c\" cx=\"" << left + 68
      << "\" cy=\"" << H - 11 << "\" r=\"4\"/><text x=\"" << left + 78 << "\" y=\"" << H - 7
      << "\">cold: code and data flushed</text>\n";
  for (const Row& r : rows) {
    if (r.scene != scene || !(r.hot > 0)) continue;
    const double y = Y(error(r)), size = r.preset.empty() ? 3.5 : 6;
    out << "<circle class=\"h\" cx=\"" << X(r.hot) << "\" cy=\"" << y << "\" r=\"" << size << "\"><title>"
        << r.policy << ": " << r.value << "</title></circle><circle class=\"c\" cx=\"" << X(r.cold)
        << "\" cy=\"" << y << "\" r=\"" << size << "\"/>\n";
    if (!r.preset.empty())
      out << "<text class=\"p\" x=\"" << X(r.hot) + 9 << "\" y=\"" << y - 7 << "\">" << r.preset
          << "</text>\n";
  }
  out << "</svg>\n";
  return out.str();
}

void write_pictures(const std::vector<Row>& rows, const std::string& folder) {
  int number = 0;
  for (const std::string& scene : scenes_of(rows)) {
    const std::string file = folder + "/cost_and_error_" + std::to_string(++number) + ".svg";
    std::ofstream out(file);
    out << picture(rows, scene);
    out.flush();
    if (!out) throw std::runtime_error("cannot write " + file);
  }
}

}  // namespace trade
