// SPDX-License-Identifier: BSD-3-Clause
// Writes a skin file as JSON.
#pragma once

#include <charconv>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "skinctl/io/skin_contents.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Writes the tables, a cell a line.
class SkinJsonWriter {
 public:
  explicit SkinJsonWriter(const SkinFile& file) {
    out_ = "{\n  \"format\": \"skinctl-skin-1\",\n  \"links\": [";
    const char* between = "\n";
    for (const SkinFile::Link& link : file.links) {
      out_ += between + ("    {\"name\": " + text(link.name)) + ", \"radius\": " + number(link.radius) +
              ", \"length\": " + number(link.length);
      const Xyz<double>& a = link.joint_axis;
      if (dot(a, a) > 0) out_ += ", \"joint_axis\": " + list({a.x, a.y, a.z});
      out_ += '}';
      between = ",\n";
    }
    out_ += "\n  ],\n  \"patches\": [";
    between = "\n";
    for (const SkinFile::Patch& p : file.patches) {
      out_ += between;
      patch(p);
      between = ",\n";
    }
    out_ += "\n  ]";
    if (!file.regions.empty()) regions(file);
    out_ += "\n}\n";
  }
  [[nodiscard]] std::string take() { return std::move(out_); }

 private:
  static std::string number(double x) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, x == 0 ? 0 : x);
    return std::string(text, end.ptr);
  }
  static std::string text(const std::string& x) {
    return nlohmann::json(x).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  template <class Range>
  static std::string listed_numbers(const Range& x) {
    std::string out = "[";
    for (const double value : x) out += (out.size() > 1 ? ", " : "") + number(value);
    return out + ']';
  }
  static std::string list(std::initializer_list<double> x) { return listed_numbers(x); }
  static std::string pose(const SkinPose& X) {
    return "{\"p\": " + list({X.p.x, X.p.y, X.p.z}) + ", \"q\": " + listed_numbers(X.q) + '}';
  }

  void patch(const SkinFile::Patch& p) {
    out_ += "    {\n      \"name\": " + text(p.name) + ",\n      \"link\": " + text(p.link) +
            ",\n      \"X_LinkRoot\": " + pose(p.X_LinkRoot) +
            ",\n      \"gains\": {\"force\": " + number(p.gains.force) +
            ", \"proximity\": " + number(p.gains.proximity) + "},\n";
    if (!p.covariance.empty()) out_ += "      \"covariance\": " + listed_numbers(p.covariance) + ",\n";
    out_ += "      \"cells\": [";
    const char* between = "\n";
    for (const SkinFile::Cell& c : p.cells) {
      out_ += between;
      cell(c);
      between = ",\n";
    }
    out_ += "\n      ]\n    }";
  }
  void cell(const SkinFile::Cell& c) {
    out_ += "        {\"id\": " + std::to_string(c.id) + ", \"X_RootCell\": " + pose(c.X_RootCell);
    if (!c.neighbours.empty()) {
      out_ += ", \"neighbours\": [";
      for (std::size_t i = 0; i < c.neighbours.size(); ++i)
        out_ += (i > 0 ? ", " : "") +
                (c.neighbours[i] == SkinFile::nobody ? std::string("null") : std::to_string(c.neighbours[i]));
      out_ += ']';
    }
    if (c.group != 0) out_ += ", \"group\": " + std::to_string(c.group);
    if (c.threshold) out_ += ", \"threshold\": " + number(*c.threshold);
    if (c.gain != 1) out_ += ", \"gain\": " + number(c.gain);
    if (!c.covariance.empty()) out_ += ", \"covariance\": " + listed_numbers(c.covariance);
    if (!c.masked.empty()) out_ += ", \"masked\": " + text(c.masked);
    out_ += '}';
  }
  void regions(const SkinFile& file) {
    out_ += ",\n  \"regions\": [";
    const char* between = "\n";
    for (const SkinFile::Region& r : file.regions) {
      out_ += between + ("    {\"name\": " + text(r.name)) + ", \"cells\": [";
      for (std::size_t i = 0; i < r.cells.size(); ++i)
        out_ += (i > 0 ? ", " : "") + std::to_string(r.cells[i]);
      out_ += "], \"weight\": " + number(r.weight);
      if (std::isfinite(r.force_limit)) out_ += ", \"force_limit\": " + number(r.force_limit);
      out_ += '}';
      between = ",\n";
    }
    out_ += "\n  ]";
  }

  std::string out_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
