#include "examples/adapters/skin/xela.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace adapters::skin {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using nlohmann::json;

constexpr std::size_t max_sensors = 64, max_taxels = 1024, max_text = std::size_t(1) << 20;

const json* member(const json& table, const char* key) {
  const auto found = table.find(key);
  return found == table.end() || found->is_null() ? nullptr : &*found;
}
/// Numbers of up to four hexadecimal digits between commas, exactly as many as there is room for.
bool read_hexadecimal(std::string_view text, std::span<std::array<std::uint16_t, 3>> taxels) {
  const char *at = text.data(), *end = at + text.size();
  for (std::size_t k = 0; k < 3 * taxels.size(); ++k) {
    if (k > 0 && (at == end || *at++ != ',')) return false;
    const auto [after, error] = std::from_chars(at, end, taxels[k / 3][k % 3], 16);
    if (error != std::errc() || after - at > 4) return false;
    at = after;
  }
  return at == end;
}
bool read_list(const json& list, std::span<std::array<std::uint16_t, 3>> taxels) {
  if (!list.is_array() || list.size() != 3 * taxels.size()) return false;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const auto x = list[k].is_number_integer() ? list[k].get<std::int64_t>() : -1;
    if (x < 0 || x > 65535) return false;
    taxels[k / 3][k % 3] = static_cast<std::uint16_t>(x);
  }
  return true;
}
bool read_forces(const json& list, std::vector<std::array<float, 3>>& taxels, std::size_t size) {
  if (!list.is_array() || list.size() != 3 * size) return false;
  taxels.resize(size);
  for (std::size_t k = 0; k < list.size(); ++k) {
    const double x = list[k].is_number() ? list[k].get<double>() : std::nan("");
    if (!(std::abs(x) < 1e6)) return false;
    taxels[k / 3][k % 3] = static_cast<float>(x);
  }
  return true;
}
bool read_module(const json& value, XelaModule& out) {
  const json* taxels = value.is_object() ? member(value, "taxels") : nullptr;
  const auto count = taxels != nullptr && taxels->is_number_integer() ? taxels->get<std::int64_t>() : 0;
  if (count < 1 || count > std::int64_t(max_taxels)) return false;
  out.counts.resize(static_cast<std::size_t>(count));
  const json *data = member(value, "data"), *integer = member(value, "integer");
  const bool counted =
      data != nullptr ? data->is_string() && read_hexadecimal(data->get_ref<const std::string&>(), out.counts)
                      : integer != nullptr && read_list(*integer, out.counts);
  const json* forces = member(value, "calibrated");
  return counted && (forces == nullptr || read_forces(*forces, out.forces, out.counts.size()));
}

}  // namespace

XelaText parse_xela(std::string_view text, XelaMessage& out) {
  out = {};
  if (text.size() > max_text) return XelaText::nonsense;
  const json whole = json::parse(text, nullptr, false);
  const json* number = whole.is_object() ? member(whole, "message") : nullptr;
  if (number == nullptr) return XelaText::nonsense;
  if (number->is_string() && number->get_ref<const std::string&>() == "Welcome") return XelaText::welcome;
  // Above 2^62 differences of two numbers could overflow.
  if (!number->is_number_integer()) return XelaText::nonsense;
  out.number = number->get<std::int64_t>();
  if (out.number < 0 || out.number > (std::int64_t(1) << 62)) return XelaText::nonsense;
  if (const json* time = member(whole, "time"); time != nullptr && time->is_number())
    out.time = time->get<double>();
  if (!(out.time > 0 && out.time < 1e10)) out.time = 0;
  for (const auto& [key, value] : whole.items()) {
    std::uint32_t sensor = 0;
    const auto [after, error] = std::from_chars(key.data(), key.data() + key.size(), sensor);
    if (error != std::errc() || after != key.data() + key.size()) continue;
    XelaModule module{.sensor = sensor, .counts = {}, .forces = {}};
    if (sensor >= 1 && sensor <= max_sensors && key[0] != '0' && read_module(value, module)) {
      out.modules.push_back(std::move(module));
    } else {
      ++out.refused;
    }
  }
  // One key a sensor: an object has each key once, and no number has two spellings.
  std::sort(out.modules.begin(), out.modules.end(), [](auto& a, auto& b) { return a.sensor < b.sensor; });
  return XelaText::message;
}

struct XelaClient::Connection {
  explicit Connection(const std::string& host, std::uint16_t port, Timeout timeout) : stream(io) {
    const std::string peer = "XELA's server at " + host + ":" + std::to_string(port);
    const auto wait = [&](const char* what, auto&& start) {
      beast::error_code error = asio::error::would_block;
      start(error);
      io.restart();
      io.run_for(timeout);
      if (error == asio::error::would_block) {  // its handler has to run while `error` lives
        beast::get_lowest_layer(stream).close();
        io.restart();
        io.run();
        throw ConnectionError(peer + ": " + what + ": no answer");
      }
      if (error) throw ConnectionError(peer + ": " + what + ": " + error.message());
    };
    asio::ip::tcp::resolver resolver(io);
    asio::ip::tcp::resolver::results_type found;
    try {
      found = resolver.resolve(host, std::to_string(port));
    } catch (const boost::system::system_error& e) {
      throw ConnectionError(peer + ": " + e.what());
    }
    wait("connect", [&](auto& error) {
      beast::get_lowest_layer(stream).async_connect(found, [&error](auto e, const auto&) { error = e; });
    });
    stream.read_message_max(max_text);
    wait("WebSocket", [&](auto& error) {
      stream.async_handshake(host + ":" + std::to_string(port), "/", [&error](auto e) { error = e; });
    });
    read();
  }
  ~Connection() {
    beast::get_lowest_layer(stream).close();
    try {
      io.restart();
      io.run();
    } catch (...) {
    }
  }
  void read() {
    arrived = false;
    buffer.consume(buffer.size());
    stream.async_read(buffer, [this](auto error, std::size_t) {
      arrived = !error;
      closed = bool(error);
    });
  }
  /// Whether the text in the buffer is a message that counts.
  bool take() {
    const auto bytes = buffer.cdata();
    const std::string_view text(static_cast<const char*>(bytes.data()), bytes.size());
    const auto what = stream.got_text() ? parse_xela(text, message) : XelaText::nonsense;
    counts.nonsense += what == XelaText::nonsense ? 1u : 0u;
    if (what != XelaText::message) return false;
    counts.refused += message.refused;
    if (newest && message.number <= *newest) {
      ++counts.late;
      return false;
    }
    if (newest) counts.lost += static_cast<std::uint64_t>(message.number - *newest - 1);
    newest = message.number;
    ++counts.messages;
    return true;
  }

  asio::io_context io;
  beast::websocket::stream<beast::tcp_stream> stream;
  beast::flat_buffer buffer;
  XelaMessage message;
  std::optional<std::int64_t> newest;
  Counts counts;
  bool arrived = false, closed = false;
};

XelaClient::XelaClient(const std::string& host, std::uint16_t port, Timeout timeout)
    : connection_(std::make_unique<Connection>(host, port, timeout)) {}
XelaClient::~XelaClient() = default;

const XelaMessage* XelaClient::next(can::Deadline deadline) {
  Connection& c = *connection_;
  while (!c.closed) {
    if (!c.arrived) {
      c.io.restart();
      if (c.io.poll_one() == 0 && c.io.run_one_until(deadline) == 0) return nullptr;
      continue;
    }
    const bool counts = c.take();
    c.read();
    if (counts) return &c.message;
    if (std::chrono::steady_clock::now() >= deadline) return nullptr;  // whatever it floods us with
  }
  return nullptr;
}
bool XelaClient::closed() const noexcept {
  return connection_->closed;
}
const XelaClient::Counts& XelaClient::counts() const noexcept {
  return connection_->counts;
}

}  // namespace adapters::skin
