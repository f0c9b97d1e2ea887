#include "examples/teach/written.hpp"

#include <array>
#include <vector>

#include "examples/support/text.hpp"

namespace teach {
namespace {
using namespace skinctl;
using examples::text;

/// Steps in a row; a loop has its body in `first`, a branch what follows yes in `first` and no in `second`.
struct Item;
using Block = std::vector<Item>;
struct Item {
  enum class What { step, loop, branch } what = What::step;
  std::uint8_t step = 0;
  Block first, second;
};

/// Reads a graph as loops and branches. False: it is another graph.
class Reader {
 public:
  explicit Reader(const Task& t) : t_(t) {}
  [[nodiscard]] bool read(std::uint8_t at, std::uint8_t until, Block& out) {
    while (at != until) {
      if (at >= t_.size || read_[at]) return false;
      read_[at] = true;
      const Step& s = t_.steps[at];
      Item item{Item::What::step, at, {}, {}};
      if (s.border != no_border && s.no != nowhere) {
        item.what = Item::What::branch;
        const std::uint8_t meet = join(s.done, s.no, until);
        if (!read(s.done, meet, item.first) || !read(s.no, meet, item.second)) return false;
        out.push_back(item);
        at = meet;
        continue;
      }
      if (s.no != nowhere && s.no != ask_person) {
        item.what = Item::What::loop;
        if (!read(s.done, at, item.first)) return false;
        out.push_back(item);
        at = s.no;
        continue;
      }
      out.push_back(item);
      at = s.done;
    }
    return true;
  }

 private:
  /// The step behind `at`: behind a loop, if it is one.
  [[nodiscard]] std::uint8_t behind(std::uint8_t at) const {
    const Step& s = t_.steps[at];
    return s.border == no_border && s.no != nowhere && s.no != ask_person ? s.no : s.done;
  }
  /// Where two ways meet again, `until` at the latest.
  [[nodiscard]] std::uint8_t join(std::uint8_t a, std::uint8_t b, std::uint8_t until) const {
    std::array<bool, max_steps> on_first{};
    for (; a != until && a < t_.size && !on_first[a]; a = behind(a)) on_first[a] = true;
    for (std::uint8_t steps = 0; b != until && b < t_.size && steps < t_.size; b = behind(b), ++steps)
      if (on_first[b]) return b;
    return until;
  }

  const Task& t_;
  std::array<bool, max_steps> read_{};
};

std::string edge(std::uint8_t to) {
  return to == finish ? "the end" : to == ask_person ? "a question" : text("%d", to + 1);
}
std::string place(const NamedTask& named, const Step& s) {
  if (s.place >= named.task.place_count) return "where it is";
  const TaughtPlace& p = named.task.places[s.place];
  const auto at = p.X_MH.origin();
  return text(p.mark == 0 ? "at (%.2f, %.2f, %.2f) m in %s" : "at (%+.2f, %+.2f, %+.2f) m from the %s", at.x,
              at.y, at.z, named.classes.name(p.mark).c_str());
}

/// Sentences of a block.
void say(const NamedTask& named, const Block& block, const std::string& indent, std::string& out) {
  const auto line = [&](const std::string& words) { out += indent + words + '\n'; };
  for (const Item& i : block) {
    const Step& s = named.task.steps[i.step];
    const std::string role = named.classes.name(s.role);
    if (i.what == Item::What::loop) {
      line("until no " + role + " is left:");
      say(named, i.first, indent + "  ", out);
    } else if (s.does == &activity::Take::rule) {
      line("take the " + role);
    } else if (s.does == &activity::Use::rule) {
      line("use the " + role + " " + place(named, s));
    } else if (s.does == &activity::Release::rule) {
      line("put the " + role + " down " + place(named, s));
    } else if (s.does == &activity::Squeeze::rule) {
      line("squeeze the " + role + " " + place(named, s));
    }
    if (i.what != Item::What::branch) continue;
    line(text("if it is %.0f N/m or harder:", named.task.borders[s.border]));
    say(named, i.first, indent + "  ", out);
    line(text("softer than %.0f N/m:", named.task.borders[s.border]));
    say(named, i.second, indent + "  ", out);
  }
}

/// A drawing of rows and columns.
class Drawing {
 public:
  explicit Drawing(const NamedTask& named) : named_(named) {}
  [[nodiscard]] static int width(const Block& block) {
    int out = 1;
    for (const Item& i : block)
      out = std::max({out, width(i.first) + (i.what == Item::What::branch ? width(i.second) : 0)});
    return out;
  }
  /// The row behind the block.
  int draw(const Block& block, int column, int row) {
    for (const Item& i : block) {
      const int here = row;
      box(i.step, column, row++);
      if (i.what == Item::What::step) continue;
      if (i.what == Item::What::loop) {
        row = draw(i.first, column, row);
        back(column, row - 1, here);
        continue;
      }
      const Step& s = named_.task.steps[i.step];
      const int beside = column + width(i.first);
      arrow(column, here, beside, row, text("below %.0f N/m", named_.task.borders[s.border]));
      const int first = draw(i.first, column, row), second = draw(i.second, beside, row);
      if (first == second && beside > column)
        line(x(column), y(first - 1) + 20, x(beside), y(first - 1) + 20);
      row = std::max(first, second);
    }
    return row;
  }
  [[nodiscard]] std::string svg(int columns, int rows) const {
    return text(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" "
               "font-size=\"13\" text-anchor=\"middle\">\n<rect width=\"100%%\" height=\"100%%\" "
               "fill=\"white\"/>\n",
               columns * 240 + 40, rows * 56 + 24) +
           out_ + "</svg>\n";
  }

 private:
  [[nodiscard]] static int x(int column) { return 150 + 240 * column; }
  [[nodiscard]] static int y(int row) { return 36 + 56 * row; }
  void line(int x1, int y1, int x2, int y2) {
    out_ += text("<line x1=\"%d\" y1=\"%d\" x2=\"%d\" y2=\"%d\" stroke=\"#666\"/>\n", x1, y1, x2, y2);
  }
  void box(std::uint8_t step, int column, int row) {
    const Step& s = named_.task.steps[step];
    if (row > 0) line(x(column), y(row) - 36, x(column), y(row) - 20);
    std::string words = named_.classes.name(s.role);
    if (s.place < named_.task.place_count &&
        (s.does == &activity::Find::rule || s.does == &activity::Release::rule))
      words += ", " + named_.classes.name(named_.task.places[s.place].mark);
    out_ += text(
        "<rect x=\"%d\" y=\"%d\" width=\"180\" height=\"40\" rx=\"6\" fill=\"#eef3fa\" stroke=\"#36c\"/>\n"
        "<text x=\"%d\" y=\"%d\" font-weight=\"bold\">%s</text><text x=\"%d\" y=\"%d\">%s</text>\n",
        x(column) - 90, y(row) - 20, x(column), y(row) - 3, s.does->name, x(column), y(row) + 14,
        words.c_str());
  }
  void arrow(int column, int row, int beside, int below, const std::string& words) {
    line(x(column) + 90, y(row), x(beside), y(row));
    line(x(beside), y(row), x(beside), y(below) - 20);
    out_ += text("<text x=\"%d\" y=\"%d\">%s</text>\n", (x(column) + 90 + x(beside)) / 2 + 20, y(row) - 6,
                 words.c_str());
  }
  void back(int column, int from, int to) {
    const int left = x(column) - 120;
    line(x(column) - 90, y(from), left, y(from));
    line(left, y(from), left, y(to));
    line(left, y(to), x(column) - 90, y(to));
    out_ += text("<path d=\"M%d %d l-8 -4 v8 z\" fill=\"#666\"/>\n", x(column) - 90, y(to));
  }
  const NamedTask& named_;
  std::string out_;
};

std::string node(const NamedTask& named, const Step& s, const std::string& indent) {
  std::string out = indent + (s.no != nowhere ? "<Condition" : "<Action") + " ID=\"" + s.does->name +
                    "\" role=\"" + named.classes.name(s.role) + "\"";
  if (s.place < named.task.place_count) {
    const TaughtPlace& p = named.task.places[s.place];
    const auto at = p.X_MH.origin(), r = log_so3(p.X_MH.axes());
    out += " mark=\"" + named.classes.name(p.mark) + "\"" +
           text(" x=\"%.6g\" y=\"%.6g\" z=\"%.6g\" rx=\"%.6g\" ry=\"%.6g\" rz=\"%.6g\"", at.x, at.y, at.z,
                r.x, r.y, r.z);
  }
  if (s.border != no_border) out += text(" border=\"%.6g\"", named.task.borders[s.border]);
  return out + "/>\n";
}
void nodes(const NamedTask& named, const Block& block, const std::string& indent, std::string& out) {
  const std::string in = indent + "  ";
  for (const Item& i : block) {
    const Step& s = named.task.steps[i.step];
    if (i.what == Item::What::step) {
      out += node(named, s, indent);
    } else if (i.what == Item::What::loop) {
      out += indent + "<ForceSuccess>\n" + in + "<KeepRunningUntilFailure>\n" + in + "  <Sequence>\n";
      out += node(named, s, in + "    ");
      nodes(named, i.first, in + "    ", out);
      out += in + "  </Sequence>\n" + in + "</KeepRunningUntilFailure>\n" + indent + "</ForceSuccess>\n";
    } else {
      out += indent + "<IfThenElse>\n" + node(named, s, in);
      for (const Block* side : {&i.first, &i.second}) {
        out += in + "<Sequence>\n";
        nodes(named, *side, in + "  ", out);
        out += in + "</Sequence>\n";
      }
      out += indent + "</IfThenElse>\n";
    }
  }
}
/// The steps in a row, where they are no loops and branches.
Block in_a_row(const Task& t) {
  Block out;
  for (std::uint8_t i = 0; i < t.size; ++i) out.push_back({Item::What::step, i, {}, {}});
  return out;
}
Block block_of(const Task& t, bool& structured) {
  Block out;
  structured = Reader(t).read(0, finish, out);
  return structured ? out : in_a_row(t);
}
}  // namespace

std::string to_text(const NamedTask& named) {
  bool structured = false;
  const Block block = block_of(named.task, structured);
  std::string out;
  if (structured) {
    say(named, block, "", out);
    return out;
  }
  for (std::size_t i = 0; i < named.task.size; ++i) {
    const Step& s = named.task.steps[i];
    out += text("%zu. %s the %s %s, then %s", i + 1, s.does->name, named.classes.name(s.role).c_str(),
                place(named, s).c_str(), edge(s.done).c_str());
    out += s.no == nowhere ? "\n" : "; if not, " + edge(s.no) + "\n";
  }
  return out;
}

std::string to_svg(const NamedTask& named) {
  bool structured = false;
  const Block block = block_of(named.task, structured);
  Drawing drawing(named);
  const int rows = drawing.draw(block, 0, 0);
  return drawing.svg(Drawing::width(block), rows);
}

std::string to_xml(const NamedTask& named) {
  bool structured = false;
  const Block block = block_of(named.task, structured);
  if (!structured) throw std::runtime_error("the task's graph is no tree of loops and branches");
  std::string out =
      "<root BTCPP_format=\"4\" main_tree_to_execute=\"taught\">\n  <BehaviorTree ID=\"taught\">\n    "
      "<Sequence>\n";
  nodes(named, block, "      ", out);
  return out + "    </Sequence>\n  </BehaviorTree>\n</root>\n";
}

}  // namespace teach
