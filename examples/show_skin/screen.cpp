#include "examples/show_skin/screen.hpp"

#include <algorithm>

namespace show_skin {
namespace {

/// 256-colour codes: from pale to strong orange; blue; grey. Told apart by whoever sees no red or no green.
std::string coloured(char c) {
  if (c >= '1' && c <= '9') {
    constexpr int orange[] = {230, 229, 222, 221, 220, 214, 208, 202, 196};
    return "\x1b[38;5;16;48;5;" + std::to_string(orange[c - '1']) + "m" + c + "\x1b[0m";
  }
  const char* code = c == 'o' ? "38;5;39" : c == 'x' || c == '?' ? "7" : "38;5;245";
  return std::string("\x1b[") + code + "m" + c + "\x1b[0m";
}

}  // namespace

Screen::Screen(const skinctl::SkinFile& file, const ScreenSettings& settings) : settings_(settings) {
  for (const auto& patch : file.patches) {
    patches_.push_back({patch.name + " on " + patch.link, unrolled(patch), cells_.size()});
    for (const auto& cell : patch.cells) {
      index_[cell.id] = cells_.size();
      cells_.emplace_back();
    }
  }
}

void Screen::hear(std::span<const skinctl::CellSample> samples) {
  for (const auto& s : samples) {
    const auto found = index_.find(s.cell);
    if (found == index_.end() || skinctl::check(s).any()) {
      ++unknown_;
      continue;
    }
    cells_[found->second] = {true, s.time, *std::max_element(s.force.begin(), s.force.end()), s.proximity};
  }
}

std::size_t Screen::heard(skinctl::Nanoseconds now) const {
  return static_cast<std::size_t>(std::count_if(cells_.begin(), cells_.end(), [&](const Cell& c) {
    return c.heard && now - c.time <= settings_.silent;
  }));
}

char Screen::symbol(const Cell& cell, skinctl::Nanoseconds now) const {
  if (!cell.heard) return '?';
  if (now - cell.time > settings_.silent) return 'x';
  if (cell.force > settings_.rest)
    return static_cast<char>('1' + std::clamp(static_cast<int>(9 * cell.force / settings_.full), 0, 8));
  return cell.proximity > settings_.near ? 'o' : '.';
}

std::string Screen::draw(skinctl::Nanoseconds now, const std::string& status) const {
  std::string out = status + "\n";
  for (std::size_t begin = 0; begin < patches_.size();) {
    // As many patches side by side as the width allows.
    std::size_t end = begin;
    int rows = 0;
    std::vector<int> column;
    for (int used = 0; end < patches_.size(); ++end) {
      const int wide = std::max(patches_[end].layout.columns, static_cast<int>(patches_[end].title.size()));
      if (end > begin && used + wide > settings_.width) break;
      column.push_back(used);
      used += wide + 3;
      rows = std::max(rows, patches_[end].layout.rows);
    }
    std::vector<std::string> lines(static_cast<std::size_t>(rows) + 1);
    const auto put = [](std::string& line, int at, const std::string& text) {
      if (line.size() < static_cast<std::size_t>(at)) line.resize(static_cast<std::size_t>(at), ' ');
      line.replace(static_cast<std::size_t>(at), text.size(), text);
    };
    for (std::size_t p = begin; p < end; ++p) {
      put(lines[0], column[p - begin], patches_[p].title);
      for (std::size_t k = 0; k < patches_[p].layout.cells.size(); ++k) {
        const Place place = patches_[p].layout.cells[k];
        put(lines[static_cast<std::size_t>(place.row) + 1], column[p - begin] + place.column,
            std::string(1, symbol(cells_[patches_[p].first + k], now)));
      }
    }
    out += "\n" + lines[0] + "\n";
    for (std::size_t row = 1; row < lines.size(); ++row) {
      for (const char c : lines[row])
        if (settings_.colours && c != ' ')
          out += coloured(c);
        else
          out += c;
      out += "\n";
    }
    begin = end;
  }
  return out;
}

}  // namespace show_skin
