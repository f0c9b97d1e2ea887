// A wire between a skin and the main job that changes datagrams: their clock, their number, their sender.
#pragma once

#include <array>
#include <atomic>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "examples/adapters/skin/datagram.hpp"

namespace compliant_ur5 {

class SkinWire {
 public:
  /// An open datagram of hexagons, read.
  struct Parcel {
    std::uint32_t sequence = 0;
    skinctl::Nanoseconds sent{};  ///< time of sending, sender's clock
    std::vector<skinctl::CellSample> samples{};
    bool stranger = false;  ///< whether it leaves from another port

    /// The same by a clock that shows `by` more.
    [[nodiscard]] Parcel later(skinctl::Nanoseconds by) const {
      Parcel out = *this;
      out.sent += by;
      for (auto& s : out.samples) s.time += by;
      return out;
    }
  };
  /// What leaves the wire for each datagram that enters it.
  using Change = std::function<std::vector<Parcel>(const Parcel&)>;

  /// @param to  port of this computer to which the datagrams go.
  explicit SkinWire(std::uint16_t to)
      : in_(io_, {boost::asio::ip::address_v4::loopback(), 0}),
        own_(io_, boost::asio::ip::udp::v4()),
        other_(io_, boost::asio::ip::udp::v4()),
        to_(boost::asio::ip::address_v4::loopback(), to) {
    in_.non_blocking(true);
    thread_ = std::thread([this] { run(); });
  }
  ~SkinWire() {
    end_ = true;
    thread_.join();
  }
  [[nodiscard]] std::uint16_t port() const { return in_.local_endpoint().port(); }
  /// From now on; an empty one changes nothing.
  void set(Change change) {
    const std::lock_guard lock(mutex_);
    change_ = std::move(change);
  }

 private:
  void run() {
    using namespace adapters::skin;
    std::array<std::uint8_t, largest + 1> bytes{};
    bool idle = true;
    while (!end_) {
      boost::system::error_code error;
      const std::size_t n = in_.receive(boost::asio::buffer(bytes), 0, error);
      Datagram d;
      if (error || !parse(std::span(bytes).first(n), d)) {
        std::this_thread::sleep_for(std::chrono::microseconds(200));
        idle = true;
        continue;
      }
      // Half of a period: no datagram comes now with the state of its time, now behind it.
      if (std::exchange(idle, false)) std::this_thread::sleep_for(std::chrono::milliseconds(2));
      Parcel came{.sequence = d.sequence, .sent = d.sent};
      for (std::size_t i = 0; i < d.count(); ++i) came.samples.push_back(d.sample<skinctl::Hexagon>(i));
      const std::lock_guard lock(mutex_);
      for (const Parcel& p : change_ ? change_(came) : std::vector{came}) send(p);
    }
  }
  void send(const Parcel& p) {
    std::array<std::uint8_t, adapters::skin::largest> bytes{};
    const auto n = adapters::skin::write(bytes, p.sequence, p.sent, std::span(p.samples));
    boost::system::error_code ignored;
    (p.stranger ? other_ : own_).send_to(boost::asio::buffer(bytes.data(), n), to_, 0, ignored);
  }

  boost::asio::io_context io_;
  boost::asio::ip::udp::socket in_, own_, other_;
  boost::asio::ip::udp::endpoint to_;
  Change change_;
  std::mutex mutex_;
  std::atomic<bool> end_ = false;
  std::thread thread_;
};

}  // namespace compliant_ur5
