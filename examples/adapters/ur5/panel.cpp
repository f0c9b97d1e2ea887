#include "examples/adapters/ur5/panel.hpp"

#include <array>
#include <boost/asio/connect.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

namespace adapters::ur5 {
namespace {
constexpr std::size_t longest_line = 4096, longest_answer = 65536;
}

void Dashboard::connect(const std::string& host, std::uint16_t port, Timeout timeout) {
  rest_.clear();
  timeout_ = timeout;
  stream_.connect(host, port, "the robot's dashboard", timeout);
  line("its greeting");
}

std::string Dashboard::ask(const std::string& command) {
  const std::string message = command + "\n";
  if (!stream_.write({reinterpret_cast<const std::uint8_t*>(message.data()), message.size()}, timeout_))
    throw ConnectionError("the robot's dashboard hung up");
  return line("'" + command + "'");
}

std::string Dashboard::line(const std::string& what) {
  const auto deadline = std::chrono::steady_clock::now() + timeout_;
  for (;;) {
    if (const auto end = rest_.find('\n'); end != std::string::npos) {
      std::string answer = rest_.substr(0, end);
      rest_.erase(0, end + 1);
      if (!answer.empty() && answer.back() == '\r') answer.pop_back();
      return answer;
    }
    std::array<std::uint8_t, 512> block{};
    std::size_t count = 0;
    const auto left =
        std::max(Timeout(0), std::chrono::ceil<Timeout>(deadline - std::chrono::steady_clock::now()));
    if (rest_.size() > longest_line || stream_.read_some(block, count, left) != Read::some)
      throw ConnectionError("the robot's dashboard gave no answer to " + what);
    rest_.append(block.begin(), block.begin() + static_cast<std::ptrdiff_t>(count));
  }
}

Rest::Rest(std::string host, std::uint16_t port, Timeout timeout)
    : host_(std::move(host)), port_(port), timeout_(timeout) {}

void Rest::act(const std::string& action) {
  exchange(true, "/robotstate/v1/state", "{\"action\": \"" + action + "\"}");
}

std::string Rest::get(const std::string& what) {
  const std::string word = mode_in(exchange(false, "/robotstate/v1/" + what, ""));
  if (word.empty()) throw ConnectionError("the robot's REST interface tells no " + what);
  return word;
}

std::string Rest::exchange(bool put, const std::string& target, const std::string& body) {
  namespace beast = boost::beast;
  namespace http = beast::http;
  boost::asio::io_context io;
  beast::tcp_stream stream(io);
  beast::flat_buffer buffer(longest_answer);
  // HTTP/1.0: its answers come in one piece, and one in chunks is refused (below).
  http::request<http::string_body> request(put ? http::verb::put : http::verb::get,
                                           "/universal-robots/robot-api" + target, 10);
  request.set(http::field::host, host_);
  request.set(http::field::accept, "application/json");
  if (put) {
    request.set(http::field::content_type, "application/json");
    request.body() = body;
  }
  request.prepare_payload();
  http::response_parser<http::string_body> answer;
  answer.body_limit(longest_answer);
  boost::system::error_code error;
  bool done = false, chunks = false;
  // One chain of asynchronous steps under one deadline: blocking calls of Beast have none.
  boost::asio::ip::tcp::resolver resolver(io);
  const auto endpoints = resolver.resolve(host_, std::to_string(port_), error);
  if (!error) {
    stream.expires_after(timeout_);
    stream.async_connect(endpoints, [&](boost::system::error_code e, const auto&) {
      error = e;
      if (e) return;
      http::async_write(stream, request, [&](boost::system::error_code written, std::size_t) {
        error = written;
        if (written) return;
        http::async_read_header(stream, buffer, answer, [&](boost::system::error_code header, std::size_t) {
          error = header;
          chunks = !header && answer.chunked();
          // Beast's reading of chunks (1.74) has assertions that hostile bytes reach.
          if (header || chunks) return;
          http::async_read(stream, buffer, answer, [&](boost::system::error_code read, std::size_t) {
            error = read;
            done = !read;
          });
        });
      });
    });
    io.run();
  }
  const std::string who = "the robot's REST interface at " + host_ + ":" + std::to_string(port_);
  if (chunks) throw ConnectionError(who + " answers " + target + " in chunks, which HTTP/1.0 does not have");
  if (!done) throw ConnectionError(who + " gave no answer to " + target + ": " + error.message());
  const auto& got = answer.get();
  if (got.result_int() / 100 != 2)
    throw ConnectionError(who + " refuses " + (body.empty() ? target : body) + ": " +
                          std::to_string(got.result_int()) + " " + got.body().substr(0, 200));
  return got.body();
}

std::string mode_in(const std::string& json) {
  // The answers are flat objects with one word; only capitals and _ are taken.
  const auto key = json.find("\"mode\"");
  if (key == std::string::npos) return {};
  const auto colon = json.find_first_not_of(" \t\r\n", key + 6);
  if (colon == std::string::npos || json[colon] != ':') return {};
  const auto open = json.find_first_not_of(" \t\r\n", colon + 1);
  if (open == std::string::npos || json[open] != '"') return {};
  const auto end = json.find('"', open + 1);
  if (end == std::string::npos || end - open > 40) return {};
  std::string word = json.substr(open + 1, end - open - 1);
  for (const char c : word)
    if (!(c >= 'A' && c <= 'Z') && c != '_') return {};
  return word;
}

}  // namespace adapters::ur5
