// A node that subscribes to one topic of ROS 1: it registers with the master, asks publishers for their
// streams, and reads them.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "examples/adapters/ros1/tcpros.hpp"
#include "examples/adapters/ros1/xml_rpc.hpp"
#include "examples/adapters/socket.hpp"

namespace adapters::ros1 {

struct SubscriberConfig {
  std::string master = "127.0.0.1";  ///< its host
  std::uint16_t port = 11311;
  std::string topic;
  std::string type, md5;  ///< of its messages; a publisher of others is refused
  std::string node;       ///< this node's name; empty: "/skinctl_" and the process's number
  /// This computer's address, as the master and the publishers reach it; empty: the one on the way to the
  /// master. The node listens there and nowhere else.
  std::string address;
  Timeout timeout{1000};  ///< of a call, and of a connection to a publisher
  Timeout again{1000};    ///< a publisher that was lost is tried again after this
  Timeout anew{5000};     ///< heard nobody for so long: registers again, as the master may be another one
  std::size_t largest = 4u << 20;   ///< longest message [bytes]
  std::size_t most_publishers = 8;  ///< heard at once
};

/// Subscribed from construction to destruction. Everything happens in `poll`; a call to a slow node holds it
/// for `timeout` at most, and streams wait in their sockets meanwhile.
///
/// The master's word is taken: it names publishers, and this node connects to them. Only the master's address
/// may call this node.
class Subscriber {
 public:
  /// What takes a message. @param publisher  whose, from 0; valid for its connection.
  using Take = std::function<void(std::size_t publisher, std::span<const std::uint8_t> message)>;

  /// Registers. Throws `ConnectionError` where the master cannot be reached or refuses, `ConfigurationError`
  /// for a topic, type or name that is none.
  explicit Subscriber(SubscriberConfig config);
  ~Subscriber();
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;

  /// Gives all messages that have arrived to `take`; waits at most `timeout` where there are none.
  void poll(Timeout timeout, const Take& take);

  /// Publishers whose streams are open.
  [[nodiscard]] std::size_t connected() const noexcept;
  /// What was last in the way of hearing a publisher; empty: nothing.
  [[nodiscard]] const std::string& trouble() const noexcept { return trouble_; }
  /// The master told this node to go (another one of its name has registered).
  [[nodiscard]] bool dismissed() const noexcept { return dismissed_; }
  [[nodiscard]] const std::string& node() const noexcept { return config_.node; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Publisher {
    explicit Publisher(std::string u) : uri(std::move(u)) {}

    std::string uri;
    Stream stream{};
    Blocks blocks{0};
    bool greeted = false;
    bool gone = false;       ///< the master does not list it any more
    Clock::time_point at{};  ///< connected, or to be tried again
  };
  struct Visitor {
    Stream stream{};
    HttpMessage request{HttpMessage::Kind::request};
    Clock::time_point until{};
  };

  Value ask(const Uri& who, const std::string& name, const Call& call) const;
  Value succeed(const Uri& who, const std::string& name, const Call& call) const;
  void enrol();
  void set_publishers(const Value& uris);
  void connect(Publisher& p);
  void read(std::size_t index, const Take& take);
  void lose(Publisher& p, const std::string& why);
  void wait(Timeout timeout);
  void serve();
  [[nodiscard]] std::string answer(const std::string& body);

  SubscriberConfig config_;
  Uri master_;
  std::string here_;  ///< this node's URI
  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::ip::address master_address_;
  std::vector<std::unique_ptr<Publisher>> publishers_;
  std::vector<std::unique_ptr<Visitor>> visitors_;
  Clock::time_point heard_at_{};
  std::string trouble_;
  bool dismissed_ = false;
};

}  // namespace adapters::ros1
