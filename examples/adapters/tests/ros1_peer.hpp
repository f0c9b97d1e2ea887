// A ROS 1 master and a publisher of one topic, in a thread; their bytes are written by hand from ROS's Master
// API, Slave API and TCPROS pages: texts without a type and <i4> as roscpp sends them, <string> and <int> as
// rospy does.
#pragma once

#include <poll.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace ros1_peer {

namespace ip = boost::asio::ip;

inline std::string length(std::size_t n) {
  std::string out;
  for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(n >> shift);
  return out;
}
inline std::string field(const std::string& text) {
  return length(text.size()) + text;
}

class Peer {
 public:
  explicit Peer(std::string topic)
      : topic_(std::move(topic)),
        master_(io_, any()),
        publisher_(io_, any()),
        stream_(io_, any()),
        thread_([this] { run(); }) {}
  ~Peer() {
    end_ = true;
    thread_.join();
  }

  // What goes wrong; set before the subscriber comes, or while it listens.
  std::atomic<bool> lists_publisher{true};  ///< in the master's answer
  std::atomic<bool> master_refuses{false}, wrong_sum{false}, refuses_stream{false}, silent_publisher{false};
  std::atomic<bool> byte_by_byte{false};

  std::uint16_t master_port() const { return master_.local_endpoint().port(); }
  std::string publisher_uri() const {
    return "http://127.0.0.1:" + std::to_string(publisher_.local_endpoint().port()) + "/";
  }
  /// Sends these bytes on every open stream, with their length before them.
  void publish(const std::vector<std::uint8_t>& message) {
    send(field(std::string(message.begin(), message.end())));
  }
  void send(const std::string& bytes) {
    const std::lock_guard lock(mutex_);
    boost::system::error_code ignored;
    for (auto& s : streams_) {
      if (!byte_by_byte) boost::asio::write(s, boost::asio::buffer(bytes), ignored);
      for (std::size_t k = 0; byte_by_byte && k < bytes.size(); ++k)
        boost::asio::write(s, boost::asio::buffer(&bytes[k], 1), ignored);
    }
  }
  void hang_up() {
    const std::lock_guard lock(mutex_);
    streams_.clear();
  }
  std::size_t streams() {
    const std::lock_guard lock(mutex_);
    return streams_.size();
  }
  /// Calls the subscriber as its master does; gives what it answers.
  std::string call_subscriber(const std::string& method, const std::string& parameters) {
    boost::system::error_code error;
    boost::asio::io_context io;
    ip::tcp::socket socket(io);
    socket.connect({ip::address_v4::loopback(), subscriber_port()}, error);
    const std::string body = "<?xml version='1.0'?>\n<methodCall>\n<methodName>" + method +
                             "</methodName>\n<params>\n" + parameters + "</params>\n</methodCall>\n";
    boost::asio::write(
        socket,
        boost::asio::buffer("POST /RPC2 HTTP/1.1\r\nHost: x\r\nContent-Type: text/xml\r\nContent-Length: " +
                            std::to_string(body.size()) + "\r\n\r\n" + body),
        error);
    std::string all;
    for (char block[512]; !error;) all.append(block, socket.read_some(boost::asio::buffer(block), error));
    return all;
  }
  /// As a master tells its subscribers who publishes.
  std::string update(const std::vector<std::string>& uris) {
    std::string data;
    for (const auto& u : uris) data += "<value><string>" + u + "</string></value>\n";
    return call_subscriber(
        "publisherUpdate",
        "<param>\n<value><string>/master</string></value>\n</param>\n<param>\n<value><string>" + topic_ +
            "</string></value>\n</param>\n<param>\n<value><array><data>\n" + data +
            "</data></array></value>\n</param>\n");
  }
  std::uint16_t subscriber_port() {
    const std::lock_guard lock(mutex_);
    return static_cast<std::uint16_t>(std::stoi(subscriber_.substr(subscriber_.rfind(':') + 1)));
  }
  std::string calls() {  ///< the methods that the master and the publisher were asked
    const std::lock_guard lock(mutex_);
    return calls_;
  }

 private:
  static ip::tcp::endpoint any() { return {ip::address_v4::loopback(), 0}; }

  void run() {
    while (!end_) {
      pollfd watched[3] = {{master_.native_handle(), POLLIN, 0},
                           {publisher_.native_handle(), POLLIN, 0},
                           {stream_.native_handle(), POLLIN, 0}};
      if (::poll(watched, 3, 5) <= 0) continue;
      boost::system::error_code error;
      if (watched[0].revents != 0) call(master_);
      if (watched[1].revents != 0) call(publisher_);
      if (watched[2].revents != 0) greet(stream_.accept(error));
    }
  }
  void call(ip::tcp::acceptor& at) {
    boost::system::error_code error;
    ip::tcp::socket socket = at.accept(error);
    std::string all;
    // `Content-Length: n` as the subscriber writes it
    for (char block[512]; !error;) {
      all.append(block, socket.read_some(boost::asio::buffer(block), error));
      const auto head = all.find("\r\n\r\n"), says = all.find("Content-Length: ");
      if (head != std::string::npos && says != std::string::npos &&
          all.size() >= head + 4 + std::stoul(all.substr(says + 16)))
        break;
    }
    const auto from = all.find("<methodName>"), to = all.find("</methodName>");
    if (from == std::string::npos || to == std::string::npos) return;
    const std::string method = all.substr(from + 12, to - from - 12);
    std::string body;
    {
      const std::lock_guard lock(mutex_);
      calls_ += method + " ";
      if (method == "registerSubscriber") {
        const auto uri = all.rfind("<string>http://");
        subscriber_ = all.substr(uri + 8, all.find("</string>", uri) - uri - 8);
        while (subscriber_.ends_with('/')) subscriber_.pop_back();
      }
    }
    if (method == "registerSubscriber" && master_refuses)
      body =
          "<value><i4>-1</i4></value><value>topic is not \xff "
          "&lt;welcome&gt;</value><value><i4>0</i4></value>";
    else if (method == "registerSubscriber")
      body = "<value><int>1</int></value>\n<value><string>Subscribed to [" + topic_ +
             "]</string></value>\n<value><array><data>\n" +
             (lists_publisher ? "<value><string>" + publisher_uri() + "</string></value>\n" : "") +
             "</data></array></value>\n";
    else if (method == "unregisterSubscriber")
      body = "<value><int>1</int></value><value><string>ok</string></value><value><int>1</int></value>";
    else if (method == "requestTopic" && refuses_stream)
      body = "<value><i4>0</i4></value><value>no protocol</value><value><i4>0</i4></value>";
    else if (method == "requestTopic")
      body =
          "<value><i4>1</i4></value><value></value><value><array><data><value>TCPROS</"
          "value><value>127.0.0.1</value><value><i4>" +
          std::to_string(stream_.local_endpoint().port()) + "</i4></value></data></array></value>";
    if (silent_publisher && method == "requestTopic") {
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      return;
    }
    body = "<?xml version='1.0'?>\n<methodResponse>\n<params>\n<param>\n<value><array><data>\n" + body +
           "</data></array></value>\n</param>\n</params>\n</methodResponse>\n";
    // roscpp says HTTP/1.1, rospy 1.0
    boost::asio::write(socket,
                       boost::asio::buffer("HTTP/1.0 200 OK\r\nServer: BaseHTTP/0.6 "
                                           "Python/3.11\r\nContent-type: text/xml\r\nContent-length: " +
                                           std::to_string(body.size()) + "\r\n\r\n" + body),
                       error);
  }
  /// Reads the header of a subscriber and answers it.
  void greet(ip::tcp::socket socket) {
    boost::system::error_code error;
    std::string all;
    for (char block[512]; !error && all.find("type=") == std::string::npos;)
      all.append(block, socket.read_some(boost::asio::buffer(block), error));
    const auto value = [&](const std::string& name) {
      const auto at = all.find(name + "=");
      if (at == std::string::npos || at < 4) return std::string();
      const std::size_t n = static_cast<unsigned char>(all[at - 4]);
      return all.substr(at + name.size() + 1, n - name.size() - 1);
    };
    std::string fields = field("callerid=/hand_made") + field("latching=0") + field("type=" + value("type"));
    fields += field("md5sum=" + (wrong_sum ? std::string(32, '0') : value("md5sum")));
    if (value("topic") != topic_) fields = field("error=topic " + value("topic") + " is not published here");
    boost::asio::write(socket, boost::asio::buffer(field(fields)), error);
    const std::lock_guard lock(mutex_);
    streams_.push_back(std::move(socket));
  }

  std::string topic_;
  boost::asio::io_context io_;
  ip::tcp::acceptor master_, publisher_, stream_;
  std::mutex mutex_;
  std::vector<ip::tcp::socket> streams_;
  std::string subscriber_, calls_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace ros1_peer
