// One TCP connection of the simulator: bounded buffers, and a clear end for peers that do not read.
#pragma once

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace simulated_ur5 {

/// Reads in chunks and writes from a queue of at most `limit` bytes; a peer that lets it fill is closed.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  using Socket = boost::asio::ip::tcp::socket;

  Connection(Socket socket, std::size_t limit) : socket_(std::move(socket)), limit_(limit) {
    boost::system::error_code ignored;
    socket_.set_option(boost::asio::ip::tcp::no_delay(true), ignored);
  }

  /// Gets every received chunk. False: close once everything is sent.
  std::function<bool(std::span<const std::uint8_t>)> on_bytes;
  /// Whether what came so far ends in the middle of a message.
  std::function<bool()> unfinished;
  /// Called once, with the reason.
  std::function<void(const char* why)> on_closed;

  void start() { read(); }

  void send(std::span<const std::uint8_t> bytes) {
    if (!open_ || closing_) return;
    if (queued() + bytes.size() > limit_) {
      close("it stopped reading");
      return;
    }
    waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
    write();
  }
  void close_when_sent() {
    closing_ = true;
    if (open_ && writing_.empty() && waiting_.empty()) close("closed by the controller");
  }
  void close(const char* why) {
    if (!open_) return;
    open_ = false;
    boost::system::error_code ignored;
    socket_.shutdown(Socket::shutdown_both, ignored);
    socket_.close(ignored);
    if (on_closed) on_closed(why);
  }
  bool is_open() const { return open_; }
  /// When the last bytes came.
  std::chrono::steady_clock::time_point heard_at() const { return heard_at_; }
  /// The peer has not read for so long, though there is something for it.
  bool stuck(std::chrono::steady_clock::duration longest) const {
    return queued() > 0 && std::chrono::steady_clock::now() - moved_at_ > longest;
  }
  std::size_t queued() const { return writing_.size() + waiting_.size(); }

 private:
  void read() {
    socket_.async_read_some(
        boost::asio::buffer(chunk_),
        [self = shared_from_this()](const boost::system::error_code& error, std::size_t n) {
          if (!self->open_) return;
          if (error) {
            self->close("the peer left");
            return;
          }
          self->heard_at_ = std::chrono::steady_clock::now();
          if (!self->closing_ && self->on_bytes && !self->on_bytes({self->chunk_.data(), n}))
            self->close_when_sent();
          if (self->open_) self->read();
        });
  }
  void write() {
    if (!writing_.empty() || waiting_.empty()) return;
    std::swap(writing_, waiting_);
    moved_at_ = std::chrono::steady_clock::now();
    boost::asio::async_write(
        socket_, boost::asio::buffer(writing_),
        [self = shared_from_this()](const boost::system::error_code& error, std::size_t) {
          self->writing_.clear();
          if (!self->open_) return;
          if (error) {
            self->close("the peer left");
            return;
          }
          self->write();
          if (self->closing_) self->close_when_sent();
        });
  }

  Socket socket_;
  std::size_t limit_;
  std::array<std::uint8_t, 4096> chunk_{};
  std::vector<std::uint8_t> writing_, waiting_;
  bool open_ = true, closing_ = false;
  std::chrono::steady_clock::time_point heard_at_ = std::chrono::steady_clock::now(), moved_at_ = heard_at_;
};

}  // namespace simulated_ur5
