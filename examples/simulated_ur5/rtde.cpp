#include "examples/simulated_ur5/rtde.hpp"

#include <algorithm>
#include <cstring>

namespace simulated_ur5::rtde {

std::string_view type_name(Type type) {
  constexpr std::string_view names[] = {"BOOL",   "UINT8",    "UINT32",   "UINT64",       "INT32",
                                        "DOUBLE", "VECTOR3D", "VECTOR6D", "VECTOR6INT32", "VECTOR6UINT32"};
  return names[static_cast<std::size_t>(type)];
}

std::size_t type_size(Type type) {
  constexpr std::size_t sizes[] = {1, 1, 4, 8, 4, 8, 24, 48, 24, 24};
  return sizes[static_cast<std::size_t>(type)];
}

void Framer::feed(std::span<const std::uint8_t> bytes) {
  const std::size_t n = std::min(bytes.size(), room());
  std::memcpy(buffer_ + size_, bytes.data(), n);
  size_ += n;
}

std::optional<Framer::Frame> Framer::next() {
  if (taken_ > 0) {
    std::memmove(buffer_, buffer_ + taken_, size_ - taken_);
    size_ -= taken_;
    taken_ = 0;
  }
  if (broken_ || size_ < header_size) return std::nullopt;
  const auto claimed = static_cast<std::size_t>(buffer_[0] << 8 | buffer_[1]);
  if (claimed < header_size || claimed > largest_request) {
    broken_ = true;
    return std::nullopt;
  }
  if (size_ < claimed) return std::nullopt;
  taken_ = claimed;
  return Frame{buffer_[2], {buffer_ + header_size, claimed - header_size}};
}

std::vector<std::string_view> split_names(std::string_view names) {
  std::vector<std::string_view> out;
  while (!names.empty()) {
    const std::size_t comma = names.find(',');
    out.push_back(names.substr(0, comma));
    if (comma == std::string_view::npos) break;
    names.remove_prefix(comma + 1);
  }
  return out;
}

PackageWriter::PackageWriter(std::vector<std::uint8_t>& out, Package type)
    : BigEndianWriter(out), out_(out), start_(out.size()) {
  u16(0);
  u8(static_cast<std::uint8_t>(type));
}

void PackageWriter::finish() {
  const std::size_t size = out_.size() - start_;
  out_[start_] = static_cast<std::uint8_t>(size >> 8);
  out_[start_ + 1] = static_cast<std::uint8_t>(size);
}

void write_text(std::vector<std::uint8_t>& out, int version, Level level, std::string_view text,
                std::string_view source) {
  PackageWriter w(out, Package::text_message);
  text = text.substr(0, 255);
  source = source.substr(0, 255);
  if (version >= 2) {
    w.u8(static_cast<std::uint8_t>(text.size()));
    w.text(text);
    w.u8(static_cast<std::uint8_t>(source.size()));
    w.text(source);
    w.u8(static_cast<std::uint8_t>(level));
  } else {
    w.u8(static_cast<std::uint8_t>(level));
    w.text(text);
  }
  w.finish();
}

}  // namespace simulated_ur5::rtde
