#include "examples/skinctl_record/csv.hpp"

#include <functional>
#include <map>
#include <ostream>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/io/cdr.hpp"
#include "skinctl/io/formatted.hpp"
#include "skinctl/recording/mcap_reader.hpp"

namespace skinctl_record {
namespace {

using namespace skinctl;

struct Row {
  std::vector<std::string> names, values;
  void add(std::string name, std::string value) {
    names.push_back(std::move(name)), values.push_back(std::move(value));
  }
  void add(std::string name, double value) { add(std::move(name), formatted("%.17g", value)); }
  void add_text(std::string name, std::string_view text) {
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    add(std::move(name), quoted + '"');
  }
};
using Rows = std::function<void(const Row&)>;

std::string seconds_text(std::int64_t s, std::uint32_t ns) {
  return formatted("%lld.%09u", static_cast<long long>(s), ns);
}
void add_stamp(CdrReader& r, Row& row, const char* name) {
  const auto s = r.get<std::int32_t>();
  row.add(name, seconds_text(s, r.get<std::uint32_t>()));
}

void text_rows(CdrReader& r, Row row, const Rows& rows) {
  row.add_text("data", r.text());
  rows(row);
}
void joint_rows(CdrReader& r, Row row, const Rows& rows) {
  add_stamp(r, row, "stamp");
  static_cast<void>(r.text());
  std::vector<std::string> names;
  for (std::size_t n = r.count(5); n > 0; --n) names.emplace_back(r.text());
  for (const char* quantity : {"position", "velocity", "effort"}) {
    const std::size_t n = r.count(8);
    for (std::size_t i = 0; i < n; ++i)
      row.add((i < names.size() ? names[i] : std::to_string(i)) + '.' + quantity, r.get<double>());
  }
  rows(row);
}
void matrix_rows(CdrReader& r, Row row, const Rows& rows) {
  std::vector<std::string> labels;
  for (std::size_t n = r.count(12); n > 0; --n) {
    labels.emplace_back(r.text());
    static_cast<void>(r.get<std::uint32_t>());
    static_cast<void>(r.get<std::uint32_t>());
  }
  static_cast<void>(r.get<std::uint32_t>());
  const std::size_t n = r.count(8);
  for (std::size_t i = 0; i < n; ++i) row.add("data." + std::to_string(i), r.get<double>());
  rows(row);
}
void transform_rows(CdrReader& r, const Row& head, const Rows& rows) {
  for (std::size_t n = r.count(70); n > 0; --n) {
    Row row = head;
    add_stamp(r, row, "stamp");
    row.add_text("parent", r.text());
    row.add_text("child", r.text());
    for (const char* name : {"x", "y", "z", "qx", "qy", "qz", "qw"}) row.add(name, r.get<double>());
    rows(row);
  }
}
/// A number of a point: types 1 to 8 of sensor_msgs/PointField.
double number(std::span<const unsigned char> at, std::uint8_t type) {
  const auto as = [&]<class V>(V value) {
    std::memcpy(&value, at.data(), sizeof value);
    return static_cast<double>(value);
  };
  switch (type) {
    case 1:
      return as(std::int8_t());
    case 2:
      return as(std::uint8_t());
    case 3:
      return as(std::int16_t());
    case 4:
      return as(std::uint16_t());
    case 5:
      return as(std::int32_t());
    case 6:
      return as(std::uint32_t());
    case 7:
      return as(float());
    default:
      return as(double());
  }
}
void point_rows(CdrReader& r, Row head, const Rows& rows) {
  constexpr std::size_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  struct Field {
    std::string name;
    std::size_t offset = 0;
    std::uint8_t type = 0;
  };
  add_stamp(r, head, "stamp");
  static_cast<void>(r.text());
  static_cast<void>(r.get<std::uint32_t>());
  static_cast<void>(r.get<std::uint32_t>());
  std::vector<Field> fields;
  for (std::size_t n = r.count(13); n > 0; --n) {
    Field f;
    f.name = r.text();
    f.offset = r.get<std::uint32_t>();
    f.type = r.get<std::uint8_t>();
    static_cast<void>(r.get<std::uint32_t>());
    if (f.type < 1 || f.type > 8) refuse("skinctl_record: a point has a field of an unknown type");
    fields.push_back(std::move(f));
  }
  static_cast<void>(r.get<bool>());
  const std::size_t step = r.get<std::uint32_t>();
  static_cast<void>(r.get<std::uint32_t>());
  const auto data = r.take(r.count(1));
  for (const Field& f : fields)
    if (f.offset > step || sizes[f.type] > step - f.offset)
      refuse("skinctl_record: a field is outside of its point");
  if (step == 0) return;
  for (std::size_t at = 0; data.size() - at >= step; at += step) {
    Row row = head;
    for (const Field& f : fields) row.add(f.name, number(data.subspan(at + f.offset), f.type));
    rows(row);
  }
}

using Decode = void (*)(CdrReader&, Row, const Rows&);
Decode decoder_of(const std::string& type) {
  static const std::map<std::string, Decode> known = {
      {"std_msgs/msg/String", text_rows},
      {"sensor_msgs/msg/JointState", joint_rows},
      {"std_msgs/msg/Float64MultiArray", matrix_rows},
      {"tf2_msgs/msg/TFMessage",
       [](CdrReader& r, Row row, const Rows& rows) { transform_rows(r, row, rows); }},
      {"sensor_msgs/msg/PointCloud2", point_rows}};
  const auto found = known.find(type);
  return found != known.end() ? found->second : nullptr;
}

}  // namespace

Table write_csv(std::span<const unsigned char> file, const std::string& topic, std::ostream& out) {
  const auto contents = read_mcap(file, [](const McapMessage&) {});
  if (!contents.is_mcap) refuse("skinctl_record: no MCAP file");
  Decode decode = nullptr;
  std::string topics, type;
  for (const auto& c : contents.summary.channels) {
    topics += (topics.empty() ? "" : ", ") + c.topic;
    const auto* schema = contents.schema(c.schema);
    if (c.topic != topic) continue;
    type = schema != nullptr ? schema->name : c.encoding;
    decode = schema != nullptr && c.encoding == "cdr" ? decoder_of(schema->name) : nullptr;
  }
  if (type.empty()) {
    const std::string missing = contents.left_out();
    refuse("skinctl_record: no topic " + topic + "; there are " + topics +
           (missing.empty() ? "" : "; " + missing));
  }
  if (decode == nullptr)
    refuse("skinctl_record: " + topic + " has messages of type " + type + ", which is no table");
  Table written;
  written.left_out = contents.left_out();
  if (!contents.whole)
    written.left_out += (written.left_out.empty() ? "" : ", ") + std::string("the file was cut");
  std::vector<std::string> columns;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) out << (i > 0 ? "," : "") << cells[i];
    out << '\n';
  };
  static_cast<void>(read_mcap(file, [&](const McapMessage& m) {
    if (m.channel.topic != topic) return;
    CdrReader reader(m.bytes);
    Row row;
    row.add("time", seconds_text(m.time.count() / 1'000'000'000,
                                 static_cast<std::uint32_t>(m.time.count() % 1'000'000'000)));
    decode(reader, row, [&](const Row& r) {
      if (!reader.fits()) refuse("skinctl_record: a message of " + topic + " is cut short");
      if (columns != r.names) line(columns = r.names);
      line(r.values);
      ++written.lines;
    });
  }));
  return written;
}

}  // namespace skinctl_record
