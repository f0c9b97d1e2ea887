// SPDX-License-Identifier: BSD-3-Clause
// Skin files as JSON: the tables of `skinctl-skin-1`, field by field.
#pragma once

#include <algorithm>

#include "skinctl/io/detail/json_tree.hpp"
#include "skinctl/io/skin_contents.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The fields of one table, with errors that say where it is. A field that nobody asked for is refused.
class SkinFields {
 public:
  using Kind = JsonValue::Kind;

  SkinFields(const std::string& source, std::string where, const JsonValue& table)
      : source_(source), where_(std::move(where)), table_(table) {}

  [[noreturn]] void fail(const JsonValue& at, const std::string& what) const {
    refuse("skinctl: " + source_ + ":" + std::to_string(at.line) + ": " + where_ +
           (where_.empty() ? "" : ", ") + what);
  }
  /// The field `key`; null if it is not there and not needed.
  const JsonValue* find(const char* key, Kind kind, const char* what, bool needed) {
    asked_.push_back(key);
    const JsonValue* value = table_.find(key);
    if (value == nullptr && needed) fail(table_, std::string("no ") + key);
    if (value != nullptr && value->kind != kind)
      fail(*value, std::string(key) + " is " + value->what() + ", allowed: " + what);
    return value;
  }
  void number(const char* key, double& to, bool needed = false) {
    if (const JsonValue* value = find(key, Kind::number, "a number", needed)) to = value->number;
  }
  void text(const char* key, std::string& to, bool needed = false) {
    const JsonValue* value = find(key, Kind::text, "a text", needed);
    if (value == nullptr) return;
    if (value->text.empty()) fail(*value, std::string(key) + " is empty");
    to = value->text;
  }
  std::uint32_t whole(const JsonValue& value, const std::string& name, double most) const {
    if (value.kind != Kind::number) fail(value, name + " is " + value.what() + ", allowed: a whole number");
    if (!(value.number >= 0 && value.number <= most && value.number == std::floor(value.number)))
      fail(value,
           name + " = " + skin_number(value.number) + ", allowed: a whole number, 0 to " + skin_number(most));
    return static_cast<std::uint32_t>(value.number);
  }
  void whole(const char* key, std::uint32_t& to, double most, bool needed = false) {
    if (const JsonValue* value = find(key, Kind::number, "a whole number", needed))
      to = whole(*value, key, most);
  }
  /// Reads a list of `count` numbers, if there is one.
  void numbers(const char* key, double* to, std::size_t count, bool needed) {
    const std::string range = std::to_string(count) + " numbers";
    const JsonValue* value = find(key, Kind::list, range.c_str(), needed);
    if (value == nullptr) return;
    if (value->items.size() != count)
      fail(*value,
           std::string(key) + ": " + std::to_string(value->items.size()) + " values, allowed: " + range);
    for (std::size_t i = 0; i < count; ++i) {
      const JsonValue& item = value->items[i];
      if (item.kind != Kind::number)
        fail(item, std::string(key) + " holds " + item.what() + ", allowed: " + range);
      to[i] = item.number;
    }
  }
  void pose(const char* key, SkinPose& to) {
    const JsonValue* value = find(key, Kind::table, "a table with p and q", true);
    SkinFields fields(source_, where_ + ", " + key, *value);
    std::array<double, 3> p{};
    fields.numbers("p", p.data(), 3, true);
    fields.numbers("q", to.q.data(), 4, true);
    fields.done();
    to.p = {p[0], p[1], p[2]};
  }
  void covariance(std::vector<double>& to) {
    to.resize(21);
    numbers("covariance", to.data(), 21, false);
    if (table_.find("covariance") == nullptr) to.clear();
  }
  /// Checks a list whose tables have all been used already.
  void used_list(const char* key, bool needed) {
    const JsonValue* value = find(key, Kind::list, "a list of tables", needed);
    if (value != nullptr && !value->items.empty())
      fail(value->items[0], std::string(key) + " holds " + value->items[0].what() + ", allowed: tables");
  }
  void done() const {
    for (std::size_t i = 0; i < table_.keys.size(); ++i)
      if (std::find(asked_.begin(), asked_.end(), table_.keys[i]) == asked_.end())
        fail(table_.items[i], "unknown field " + skin_quoted(table_.keys[i]));
  }

 private:
  const std::string& source_;
  std::string where_;
  const JsonValue& table_;
  std::vector<std::string_view> asked_;
};

class SkinJsonReader {
 public:
  SkinJsonReader(std::string_view text, std::string source) {
    file_.source = std::move(source);
    const JsonTree tree(text, file_.source,
                        [this](const auto& path, const JsonValue& item, const JsonValue& owner) {
                          return finished(path, item, owner);
                        });
    const JsonValue& root = tree.root();
    SkinFields fields(file_.source, "", root);
    if (root.kind != JsonValue::Kind::table)
      fields.fail(root, std::string("the file is ") + root.what() + ", allowed: a table");
    std::string format;
    fields.text("format", format, true);
    if (format != "skinctl-skin-1")
      fields.fail(*root.find("format"), "format = " + skin_quoted(format) + ", allowed: \"skinctl-skin-1\"");
    fields.used_list("links", true);
    fields.used_list("patches", true);
    fields.used_list("regions", false);
    fields.done();
    file_.check();
  }
  [[nodiscard]] SkinFile take() { return std::move(file_); }

 private:
  using Path = std::vector<std::string>;

  bool finished(const Path& path, const JsonValue& item, const JsonValue& owner) {
    if (path == Path{"patches", "cells"}) {
      cell(item, owner);
    } else if (path == Path{"patches"}) {
      patch(item);
    } else if (path == Path{"links"}) {
      link(item);
    } else if (path == Path{"regions"}) {
      region(item);
    } else {
      return false;
    }
    return true;
  }
  void room(const JsonValue& item, std::size_t have, std::size_t most, const std::string& of) const {
    if (have >= most)
      SkinFields(file_.source, "", item).fail(item, "more than " + std::to_string(most) + " " + of);
  }
  /// A table by its name, or, where it has none yet, by its number.
  static std::string called(const char* what, const JsonValue& table, std::size_t before) {
    const JsonValue* name = table.find("name");
    return std::string(what) + " " +
           (name != nullptr && name->kind == JsonValue::Kind::text ? skin_quoted(name->text)
                                                                   : "number " + std::to_string(before + 1));
  }

  void cell(const JsonValue& item, const JsonValue& owner) {
    room(item, cells_.size(), SkinFile::max_cells_of_a_patch, "cells of a patch");
    const JsonValue* id = item.find("id");
    SkinFields fields(file_.source,
                      called("patch", owner, file_.patches.size()) + ", cell " +
                          (id != nullptr && id->kind == JsonValue::Kind::number
                               ? skin_number(id->number)
                               : "number " + std::to_string(cells_.size() + 1)),
                      item);
    SkinFile::Cell cell;
    cell.line = item.line;
    fields.whole("id", cell.id, SkinFile::highest_id, true);
    fields.pose("X_RootCell", cell.X_RootCell);
    if (const JsonValue* ports =
            fields.find("neighbours", JsonValue::Kind::list, "a list of four ids", false)) {
      if (ports->items.size() != 4)
        fields.fail(*ports, "neighbours: " + std::to_string(ports->items.size()) +
                                " values, allowed: four, an id or null for each port");
      for (const JsonValue& port : ports->items)
        cell.neighbours.push_back(port.kind == JsonValue::Kind::null
                                      ? SkinFile::nobody
                                      : fields.whole(port, "neighbours", SkinFile::highest_id));
    }
    fields.whole("group", cell.group, 65535);
    if (item.find("threshold") != nullptr)
      fields.number("threshold", cell.threshold.emplace(), true);
    else
      fields.find("threshold", JsonValue::Kind::number, "", false);
    fields.number("gain", cell.gain);
    fields.covariance(cell.covariance);
    fields.text("masked", cell.masked);
    fields.done();
    cells_.push_back(std::move(cell));
  }
  void patch(const JsonValue& item) {
    room(item, file_.patches.size(), SkinFile::max_patches, "patches");
    SkinFields fields(file_.source, called("patch", item, file_.patches.size()), item);
    SkinFile::Patch patch;
    patch.line = item.line;
    fields.text("name", patch.name, true);
    fields.text("link", patch.link, true);
    fields.pose("X_LinkRoot", patch.X_LinkRoot);
    if (const JsonValue* gains =
            fields.find("gains", JsonValue::Kind::table, "a table with force and proximity", true)) {
      SkinFields of(file_.source, called("patch", item, file_.patches.size()) + ", gains", *gains);
      of.number("force", patch.gains.force, true);
      of.number("proximity", patch.gains.proximity, true);
      of.done();
    }
    fields.covariance(patch.covariance);
    fields.used_list("cells", true);
    fields.done();
    patch.cells = std::move(cells_);
    cells_.clear();
    total_ += patch.cells.size();
    room(item, total_ - 1, SkinFile::max_cells, "cells");
    file_.patches.push_back(std::move(patch));
  }
  void link(const JsonValue& item) {
    room(item, file_.links.size(), SkinFile::max_patches, "links");
    SkinFields fields(file_.source, called("link", item, file_.links.size()), item);
    SkinFile::Link link;
    link.line = item.line;
    fields.text("name", link.name, true);
    fields.number("radius", link.radius, true);
    fields.number("length", link.length, true);
    std::array<double, 3> axis{};
    fields.numbers("joint_axis", axis.data(), 3, false);
    link.joint_axis = {axis[0], axis[1], axis[2]};
    fields.done();
    file_.links.push_back(std::move(link));
  }
  void region(const JsonValue& item) {
    room(item, file_.regions.size(), SkinFile::max_patches, "regions");
    SkinFields fields(file_.source, called("region", item, file_.regions.size()), item);
    SkinFile::Region region;
    region.line = item.line;
    fields.text("name", region.name, true);
    const JsonValue* cells = fields.find("cells", JsonValue::Kind::list, "a list of ids", true);
    for (const JsonValue& id : cells->items)
      region.cells.push_back(fields.whole(id, "cells", SkinFile::highest_id));
    fields.number("weight", region.weight);
    fields.number("force_limit", region.force_limit);
    fields.done();
    file_.regions.push_back(std::move(region));
  }

  SkinFile file_;
  std::vector<SkinFile::Cell> cells_;
  std::size_t total_ = 0;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
