// A live view's server: the Foxglove WebSocket protocol and the files of a page, on one port.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "skinctl/core/time.hpp"

namespace adapters::live {

/// A file of the page, as it is sent.
struct PageFile {
  std::string type;  ///< "text/html; charset=utf-8"
  std::string bytes;
};

/// A topic that clients may subscribe.
struct Channel {
  std::string topic;            ///< "/joint_states"
  std::string encoding;         ///< "cdr", or the name of a format of one's own
  std::string schema_name;      ///< "sensor_msgs/msg/JointState"
  std::string schema;           ///< as `MessageType` has it
  std::string schema_encoding;  ///< "ros2msg"; empty for a format without schema
  bool latched = false;         ///< the last message is kept for those who subscribe later
};

/// What a call of a service gives: whether it was done, and words.
struct Answer {
  bool done = false;
  std::string words;
};
/// A service of type std_srvs/srv/Trigger.
struct Service {
  std::string name;                ///< "/skinctl/stop"
  bool controls = true;            ///< refused without `allow_control`
  std::function<Answer()> called;  ///< in the server's thread
};

/// A topic that clients publish to, as JSON (the protocol's `clientPublish`).
struct Inlet {
  std::string topic;  ///< "/simulation/finger"
  /// In the server's thread. Not done: not understood; words are said to who published, each in place of the
  /// last.
  std::function<Answer(std::string_view)> take;
  std::function<void()> left;  ///< who published has gone, or has said that it is done
};

/// A number that clients see, and set where control is allowed.
struct Parameter {
  std::string name;
  double value = 0, lower = 0, upper = 1;
  std::function<void(double)> set;  ///< in the server's thread; none: nobody sets it
};

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< to bind
  std::uint16_t port = 0;             ///< 0: any
  std::string name = "skinctl";       ///< clients show it
  bool allow_control = false;         ///< services that control, parameters
  std::size_t queued = std::size_t(1)
                       << 20;  ///< bytes that may wait for one client; more are dropped and counted
  std::size_t clients =
      32;  ///< streams at once; a newcomer takes the place of the oldest that subscribes to nothing
  std::map<std::string, PageFile> files = {};  ///< by path, "/" for the page
  std::map<std::string, std::string> folders =
      {};  ///< "/three/": the folder of this computer whose files are served there
};

struct ServerStatistics {
  std::uint64_t clients = 0;   ///< at present
  std::uint64_t sent = 0;      ///< messages
  std::uint64_t dropped = 0;   ///< messages for clients that read too slowly
  std::uint64_t refused = 0;   ///< connections, by host, origin, sub-protocol or number
  std::uint64_t nonsense = 0;  ///< messages of clients that were not understood
};

class ServerError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Serves clients in a thread of its own; nothing that a client does delays who publishes.
///
/// Of a request, `Host` must be 127.0.0.1 or localhost with this port (or the bound address), `Origin`
/// absent, the server's own or https://app.foxglove.dev, and the sub-protocol foxglove.sdk.v1 or
/// foxglove.websocket.v1: any page in a browser can open a connection to this computer.
class FoxgloveServer {
 public:
  /// Binds. Throws `ServerError` where that fails.
  explicit FoxgloveServer(ServerOptions options);
  ~FoxgloveServer();
  FoxgloveServer(const FoxgloveServer&) = delete;
  FoxgloveServer& operator=(const FoxgloveServer&) = delete;

  [[nodiscard]] std::uint16_t port() const noexcept;
  /// "http://127.0.0.1:8765/"
  [[nodiscard]] std::string url() const;

  // Before `start`. The number of a channel is what `publish` asks for.
  std::uint32_t add(Channel channel);
  void add(Service service);
  void add(Parameter parameter);
  void add(Inlet inlet);

  void start();
  /// A message for those who subscribe its channel; the bytes are copied. From one thread at a time.
  void publish(std::uint32_t channel, skinctl::Nanoseconds time, std::span<const unsigned char> message);
  /// Whether anybody would hear it. A latched channel is always wanted.
  [[nodiscard]] bool wanted(std::uint32_t channel) const noexcept;
  /// A parameter has changed by itself: clients are told.
  void set_parameter(const std::string& name, double value);
  [[nodiscard]] ServerStatistics statistics() const noexcept;
  /// Ends all connections and the thread; `words` [optional] say why, to all that are connected, 0.1 s
  /// before.
  void stop(const std::string& words = {}) noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adapters::live
