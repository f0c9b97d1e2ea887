#include "examples/simulated_gripper/server.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <random>
#include <thread>
#include <vector>

#include "examples/support/web_guard.hpp"

namespace simulated_gripper {
namespace {

using boost::asio::ip::tcp;
using Clock = std::chrono::steady_clock;
constexpr std::size_t longest_request = 512, most_clients = 8;

}  // namespace

struct Server::Network {
  /// One client: read, answer, read.
  struct Client : std::enable_shared_from_this<Client> {
    Client(Server& s, tcp::socket k) : server(s), socket(std::move(k)), later(socket.get_executor()) {}
    void read() {
      socket.async_read_some(boost::asio::buffer(chunk),
                             [self = shared_from_this()](const boost::system::error_code& e, std::size_t n) {
                               if (e) return;
                               self->take(n);
                             });
    }
    void take(std::size_t n) {
      // An OnRobot's frames end a web page's request by themselves, and a Lacquey connects to the computer.
      if (server.config_.kind == Kind::robotiq &&
          guard.refuses({reinterpret_cast<const std::uint8_t*>(chunk.data()), n}))
        return close();
      in.append(chunk.data(), n);
      out.clear();
      auto& wrong = server.misbehaviour_;
      if (std::uniform_real_distribution<>(0, 1)(random) < wrong.lose) {
        in.clear();
        return read();
      }
      const bool good = server.answer(in, out) && in.size() < longest_request;
      if (wrong.hang_up || !good) return close();
      if (wrong.line_end_after_ack && out == "ack") out += '\n';
      if (wrong.silent) out.clear();
      if (wrong.twice) out += out;
      if (wrong.cut_short) out.resize(out.size() / 2);
      if (wrong.other_version && out.size() > 3) {
        if (server.config_.kind == Kind::onrobot) out[3] = 1;  // Modbus is protocol 0
        if (server.config_.kind == Kind::robotiq) out = "v2 " + out;
      }
      if (const int ms = wrong.late_ms; ms > 0) {
        later.expires_after(std::chrono::milliseconds(ms));
        later.async_wait([self = shared_from_this()](const boost::system::error_code& e) {
          if (!e) self->write(0);
        });
        return;
      }
      if (wrong.garbage)
        for (char& c : out)
          if (c != '\n') c = static_cast<char>(c ^ 0x5a);
      write(0);
    }
    void close() {
      boost::system::error_code ignored;
      socket.close(ignored);
    }
    void write(std::size_t from) {
      if (from == out.size()) return read();
      const std::size_t n = server.misbehaviour_.byte_by_byte ? 1 : out.size() - from;
      boost::asio::async_write(
          socket, boost::asio::buffer(out.data() + from, n),
          [self = shared_from_this(), from, n](const boost::system::error_code& e, std::size_t) {
            if (!e) self->write(from + n);
          });
    }
    Server& server;
    tcp::socket socket;
    boost::asio::steady_timer later;
    std::mt19937 random{1};
    examples::WebGuard guard;
    std::array<char, 256> chunk{};
    std::string in, out;
  };

  explicit Network(Server& s) : server(s) {}

  void accept() {
    acceptor.async_accept([this](const boost::system::error_code& e, tcp::socket socket) {
      if (e) return;
      std::erase_if(clients, [](const auto& c) { return c.expired(); });
      if (clients.size() < most_clients) {
        boost::system::error_code ignored;
        socket.set_option(tcp::no_delay(true), ignored);
        auto client = std::make_shared<Client>(server, std::move(socket));
        clients.push_back(client);
        client->read();
      }
      accept();
    });
  }
  void connect(const std::string& address, std::uint16_t port) {
    tcp::socket socket(io);
    socket.connect({boost::asio::ip::make_address(address), port});
    std::make_shared<Client>(server, std::move(socket))->read();
  }

  Server& server;
  boost::asio::io_context io;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{io.get_executor()};
  tcp::acceptor acceptor{io};
  std::vector<std::weak_ptr<Client>> clients;
  std::thread thread;
};

Server::Server(const ServerConfig& config)
    : config_(config), robotiq_(config.active), network_(std::make_unique<Network>(*this)) {
  put(config.object);
  if (config.kind == Kind::lacquey) {
    network_->connect(config.address, config.port);
  } else {
    const tcp::endpoint where(boost::asio::ip::make_address(config.address), config.port);
    auto& acceptor = network_->acceptor;
    acceptor.open(where.protocol());
    acceptor.set_option(boost::asio::socket_base::reuse_address(true));
    acceptor.bind(where);
    acceptor.listen();
    network_->accept();
  }
  network_->thread = std::thread([this] { network_->io.run(); });
}

Server::~Server() {
  network_->io.stop();
  network_->thread.join();
}

double Server::now() const {
  return config_.speed * std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}
std::uint16_t Server::port() const {
  return config_.kind == Kind::lacquey ? config_.port : network_->acceptor.local_endpoint().port();
}
void Server::put(const Object& object) {
  const std::scoped_lock lock(mutex_);
  for (Fingers* f : {&robotiq_.fingers(), &onrobot_.fingers(), &lacquey_.fingers()}) f->put(object);
}
void Server::fault(int code) {
  const std::scoped_lock lock(mutex_);
  robotiq_.fault(code);
  onrobot_.safety(static_cast<std::uint16_t>(code));
}

void Server::fingertips(std::int16_t offset) {
  const std::scoped_lock lock(mutex_);
  onrobot_.fingertips(offset);
}

Server::Seen Server::seen() {
  const std::scoped_lock lock(mutex_);
  if (config_.kind == Kind::robotiq) robotiq_.answer("", now());
  if (config_.kind == Kind::onrobot) onrobot_.answer({}, now());
  if (config_.kind == Kind::lacquey) lacquey_.hear(0, now());
  const Fingers& f = config_.kind == Kind::robotiq   ? robotiq_.fingers()
                     : config_.kind == Kind::onrobot ? onrobot_.fingers()
                                                     : lacquey_.fingers();
  return {f.opening(), f.force(), f.moving()};
}

bool Server::answer(std::string& bytes, std::string& out) {
  namespace modbus = adapters::gripper::modbus;
  const std::scoped_lock lock(mutex_);
  switch (config_.kind) {
    case Kind::robotiq:
      for (std::size_t end; (end = bytes.find('\n')) != std::string::npos; bytes.erase(0, end + 1))
        out += robotiq_.answer(std::string_view(bytes).substr(0, end), now());
      return true;
    case Kind::onrobot:
      for (;;) {
        modbus::Frame frame;
        std::size_t size = 0;
        const auto found = modbus::find_frame(
            {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, frame, size);
        if (found != modbus::Found::frame) return found == modbus::Found::more;
        const auto said = onrobot_.answer(frame, now());
        out.append(reinterpret_cast<const char*>(said.span().data()), said.span().size());
        bytes.erase(0, size);
      }
    case Kind::lacquey:
      for (; bytes.size() >= 4; bytes.erase(0, 4)) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 4; ++k) word = word << 8 | static_cast<std::uint8_t>(bytes[k]);
        lacquey_.hear(static_cast<std::int32_t>(word), now());
      }
      return true;
  }
  return false;
}

}  // namespace simulated_gripper
