#include "examples/adapters/ros1/tcpros.hpp"

#include <algorithm>

namespace adapters::ros1 {
namespace {

std::uint32_t length_at(std::span<const std::uint8_t> bytes) {
  return std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8 | std::uint32_t{bytes[2]} << 16 |
         std::uint32_t{bytes[3]} << 24;
}
void put_length(std::vector<std::uint8_t>& out, std::size_t n) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(n >> shift));
}

}  // namespace

std::optional<Fields> parse_fields(std::span<const std::uint8_t> bytes) {
  Fields fields;
  while (!bytes.empty()) {
    if (bytes.size() < 4) return std::nullopt;
    const std::size_t n = length_at(bytes);
    bytes = bytes.subspan(4);
    if (n > bytes.size()) return std::nullopt;
    const auto field = bytes.first(n);
    bytes = bytes.subspan(n);
    const auto sign = std::find(field.begin(), field.end(), std::uint8_t{'='});
    if (sign == field.end() || sign == field.begin()) return std::nullopt;
    fields.insert_or_assign(std::string(field.begin(), sign), std::string(sign + 1, field.end()));
  }
  return fields;
}

std::vector<std::uint8_t> header(const Fields& fields) {
  std::vector<std::uint8_t> out;
  std::size_t all = 0;
  for (const auto& [name, value] : fields) all += 4 + name.size() + 1 + value.size();
  put_length(out, all);
  for (const auto& [name, value] : fields) {
    put_length(out, name.size() + 1 + value.size());
    out.insert(out.end(), name.begin(), name.end());
    out.push_back('=');
    out.insert(out.end(), value.begin(), value.end());
  }
  return out;
}

std::optional<std::span<const std::uint8_t>> Blocks::next() {
  const auto left = rest();
  if (broken_ || left.size() < 4) return std::nullopt;
  const std::size_t n = length_at(left);
  if (n > largest_) {
    broken_ = true;
    return std::nullopt;
  }
  if (left.size() - 4 < n) return std::nullopt;
  given_ += 4 + n;
  return left.subspan(4, n);
}

void Blocks::drop() {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(given_));
  given_ = 0;
}

}  // namespace adapters::ros1
