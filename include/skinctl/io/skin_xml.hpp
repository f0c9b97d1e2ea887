// SPDX-License-Identifier: BSD-3-Clause
// Patch files in XML, as TUM's skin has them. Optional: needs tinyxml2 (Debian: libtinyxml2-dev; link
// tinyxml2).
#pragma once

#include <tinyxml2.h>

#include <cstring>
#include <optional>

#include "skinctl/io/detail/from_chars.hpp"
#include "skinctl/io/detail/read_text.hpp"
#include "skinctl/io/skin_contents.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The facts that a patch file in XML does not hold.
struct SkinXmlOptions {
  std::string name = "patch";
  std::string link{};  ///< link that carries the skin; empty: `baseFrame` of the file
  CellGains gains{};
  std::optional<SkinPose> X_LinkRoot{};  ///< pose of the root; none: `tf_rootCell_base` of the file
};

namespace detail {

class SkinXmlReader {
 public:
  using Element = tinyxml2::XMLElement;

  SkinXmlReader(std::string_view text, std::string source, const SkinXmlOptions& options) {
    file_.source = std::move(source);
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      fail(document.ErrorLineNum(), "", std::string("no XML: ") + document.ErrorName());
    const Element* root = document.RootElement();
    if (root == nullptr || std::strcmp(root->Name(), "SkinConfig") != 0)
      fail(root != nullptr ? root->GetLineNum() : 0, "", "the file's element is not <SkinConfig>");
    patch(*root, options);
    file_.check();
  }
  [[nodiscard]] SkinFile take() { return std::move(file_); }

 private:
  [[noreturn]] void fail(int line, const std::string& where, const std::string& what) const {
    refuse("skinctl: " + file_.source + (line > 0 ? ":" + std::to_string(line) : "") + ": " + where +
           (where.empty() ? "" : ", ") + what);
  }
  [[noreturn]] void fail(const Element& at, const std::string& what) const {
    fail(at.GetLineNum(), where_, what);
  }

  const Element& child(const Element& of, const char* name) const {
    const Element* e = of.FirstChildElement(name);
    if (e == nullptr) fail(of, std::string("<") + of.Name() + "> has no <" + name + '>');
    return *e;
  }
  /// Reads a text that is one number, blanks around it aside.
  template <class T>
  T number(const Element& at, const char* text, const std::string& what) const {
    std::string_view s = text != nullptr ? text : "";
    while (!s.empty() && std::strchr(" \t\r\n", s.front()) != nullptr) s.remove_prefix(1);
    while (!s.empty() && std::strchr(" \t\r\n", s.back()) != nullptr) s.remove_suffix(1);
    T x{};
    const auto [end, error] = detail::from_chars(s.data(), s.data() + s.size(), x);
    if (s.empty() || error != std::errc() || end != s.data() + s.size() || !(x - x == T(0)))
      fail(at, what + " = " + skin_quoted(s) +
                   ", allowed: " + (std::is_integral_v<T> ? "a whole number" : "a finite number"));
    return x;
  }
  std::uint32_t id(const Element& e, const char* attribute) const {
    const auto x =
        number<std::int64_t>(e, e.Attribute(attribute), std::string("<") + e.Name() + "> " + attribute);
    if (x < 0 || x > std::int64_t(SkinFile::highest_id))
      fail(e, std::string("<") + e.Name() + "> " + attribute + " = " + std::to_string(x) +
                  ", allowed: 0 to " + std::to_string(SkinFile::highest_id));
    return static_cast<std::uint32_t>(x);
  }
  /// Reads `<name><matrix rows cols><element row col>x</element> ...</matrix></name>`, each element once.
  template <std::size_t Rows, std::size_t Columns>
  std::array<double, Rows * Columns> matrix(const Element& of, const char* name) const {
    const Element& m = child(child(of, name), "matrix");
    const auto size = [&](const char* attribute, std::size_t expected) {
      if (number<std::int64_t>(m, m.Attribute(attribute), std::string(name) + " " + attribute) !=
          std::int64_t(expected))
        fail(m, std::string(name) + ": " + attribute + " = " + m.Attribute(attribute) +
                    ", allowed: " + std::to_string(expected));
    };
    size("rows", Rows), size("cols", Columns);
    std::array<double, Rows * Columns> out{};
    std::array<bool, Rows * Columns> seen{};
    for (const Element* e = m.FirstChildElement("element"); e != nullptr;
         e = e->NextSiblingElement("element")) {
      const auto row = number<std::int64_t>(*e, e->Attribute("row"), std::string(name) + " row");
      const auto col = number<std::int64_t>(*e, e->Attribute("col"), std::string(name) + " col");
      if (row < 0 || row >= std::int64_t(Rows) || col < 0 || col >= std::int64_t(Columns))
        fail(*e, std::string(name) + ": element " + std::to_string(row) + ", " + std::to_string(col) +
                     ", allowed: rows 0 to " + std::to_string(Rows - 1) + ", columns 0 to " +
                     std::to_string(Columns - 1));
      const std::size_t k = static_cast<std::size_t>(row) * Columns + static_cast<std::size_t>(col);
      if (seen[k]) fail(*e, std::string(name) + ": an element occurs twice");
      seen[k] = true;
      out[k] = number<double>(*e, e->GetText(), name);
    }
    for (const bool s : seen)
      if (!s) fail(m, std::string(name) + ": an element is missing");
    return out;
  }
  SkinPose pose(const Element& of) const {
    const auto p = matrix<3, 1>(of, "pos");
    const auto R = matrix<3, 3>(of, "rot");
    const Rotation<double> axes{{R[0], R[3], R[6]}, {R[1], R[4], R[7]}, {R[2], R[5], R[8]}};
    const double error = rotation_error(axes);
    if (!(error <= 1e-2))
      fail(child(of, "rot"), "rot: |R'R - 1| = " + skin_number(error) + ", allowed: <= 0.01");
    return SkinPose::of(normalised(axes), {p[0], p[1], p[2]});
  }

  void patch(const Element& root, const SkinXmlOptions& options) {
    where_ = "patch " + skin_quoted(options.name);
    SkinFile::Patch patch;
    patch.name = options.name;
    patch.link = options.link;
    patch.gains = options.gains;
    patch.line = root.GetLineNum();
    if (options.link.empty() || !options.X_LinkRoot) {
      const Element& placed = child(root, "patchExtrinsics");
      if (options.link.empty()) {
        const char* base = placed.Attribute("baseFrame");
        if (base == nullptr || *base == 0)
          fail(placed, "<patchExtrinsics> has no baseFrame, and no link is given");
        patch.link = base;
      }
      if (!options.X_LinkRoot) patch.X_LinkRoot = pose(child(placed, "tf_rootCell_base"));
    }
    if (options.X_LinkRoot) patch.X_LinkRoot = *options.X_LinkRoot;
    std::optional<std::uint32_t> root_cell;
    for (const Element* e = root.FirstChildElement("cell"); e != nullptr; e = e->NextSiblingElement("cell")) {
      if (patch.cells.size() == SkinFile::max_cells_of_a_patch) fail(*e, "more than 8192 cells of a patch");
      patch.cells.push_back(cell(*e, root_cell));
    }
    if (const char* count = root.Attribute("numberOfCells");
        count != nullptr &&
        number<std::int64_t>(root, count, "numberOfCells") != std::int64_t(patch.cells.size()))
      fail(root,
           std::string("numberOfCells = ") + count + ", but there are " + std::to_string(patch.cells.size()));
    if (root_cell) {
      bool known = false;
      for (const auto& c : patch.cells) known = known || c.id == *root_cell;
      if (!known) fail(root, "rootCellId = " + std::to_string(*root_cell) + ", allowed: an id of this file");
    }
    file_.links.push_back({patch.link, 0, 0, {}, patch.line});
    file_.patches.push_back(std::move(patch));
  }
  SkinFile::Cell cell(const Element& e, std::optional<std::uint32_t>& root_cell) {
    SkinFile::Cell cell;
    cell.line = e.GetLineNum();
    cell.id = id(e, "id");
    const std::string patch = where_;
    where_ += ", cell " + std::to_string(cell.id);
    if (e.Attribute("rootCellId") != nullptr) {
      const std::uint32_t root = id(e, "rootCellId");
      if (root_cell && *root_cell != root)
        fail(e, "rootCellId = " + std::to_string(root) + ", allowed: " + std::to_string(*root_cell) +
                    " as before");
      root_cell = root;
    }
    cell.X_RootCell = pose(e);
    if (const Element* neighbours = e.FirstChildElement("neighbors")) {
      for (const Element* n = neighbours->FirstChildElement("neighbor"); n != nullptr;
           n = n->NextSiblingElement("neighbor")) {
        if (cell.neighbours.size() == 4) fail(*n, "more than four neighbours");
        const std::uint32_t other = id(*n, "id");
        cell.neighbours.push_back(other == 0 ? SkinFile::nobody : other);
      }
      cell.neighbours.resize(4, SkinFile::nobody);
    }
    where_ = patch;
    return cell;
  }

  SkinFile file_;
  std::string where_;
};

}  // namespace detail

/// Reads a patch file from memory: `<SkinConfig>` with `<patchExtrinsics baseFrame><tf_rootCell_base>` and,
/// per `<cell id rootCellId>`, `<pos>` [m], `<rot>` (cell to root) and `<neighbors>`, whose ids are those at
/// ports 1 to 4, 0 for nobody. Rotations with few digits become the nearest rotation. Other elements are
/// skipped.
///
/// Throws `ConfigurationError`, with source, line, patch, cell, field, value and allowed range, for text that
/// is no such XML or exceeds 256 MiB, a matrix with another size or a missing element, a `<rot>` that is no
/// rotation to within 0.01, and what `SkinFile::check` refuses.
[[nodiscard]] inline SkinFile parse_skin_xml(std::string_view text, std::string source = "skin XML",
                                             const SkinXmlOptions& options = {}) {
  detail::require_text_size(text, source);
  return detail::SkinXmlReader(text, std::move(source), options).take();
}

/// Reads a patch file; see `parse_skin_xml`. Also throws `ConfigurationError` for a file that cannot be read.
[[nodiscard]] inline SkinFile read_skin_xml(const std::string& path, const SkinXmlOptions& options = {}) {
  return parse_skin_xml(detail::read_text(path), path, options);
}

/// Adds the patches of another file, such as those of one XML file a patch. Throws `ConfigurationError` where
/// `SkinFile::check` does.
inline void append(SkinFile& file, const SkinFile& other) {
  for (const SkinFile::Link& link : other.links) {
    bool known = false;
    for (const SkinFile::Link& l : file.links) known = known || l.name == link.name;
    if (!known) file.links.push_back(link);
  }
  file.patches.insert(file.patches.end(), other.patches.begin(), other.patches.end());
  file.regions.insert(file.regions.end(), other.regions.begin(), other.regions.end());
  file.check();
}

SKINCTL_END_NAMESPACE
