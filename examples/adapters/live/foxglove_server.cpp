#include "examples/adapters/live/foxglove_server.hpp"

#include <algorithm>
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <thread>
#include <vector>

namespace adapters::live {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using nlohmann::json;
using Bytes = std::vector<unsigned char>;
using Shared = std::shared_ptr<const Bytes>;

constexpr std::size_t largest_request = 64 << 10;
constexpr std::size_t most_subscriptions = 256;
constexpr std::chrono::seconds request_time{10};
constexpr const char* protocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

template <class V>
void put(Bytes& out, V value) {
  const std::size_t at = out.size();
  out.resize(at + sizeof value);
  std::memcpy(out.data() + at, &value, sizeof value);
}
template <class V>
V number_at(std::span<const unsigned char> bytes, std::size_t at) {
  V value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// std_srvs/srv/Trigger's response.
Bytes trigger_response(const Answer& answer) {
  Bytes out{0, 1, 0, 0, static_cast<unsigned char>(answer.done ? 1 : 0), 0, 0, 0};
  put(out, static_cast<std::uint32_t>(answer.words.size() + 1));
  out.insert(out.end(), answer.words.begin(), answer.words.end());
  out.push_back(0);
  return out;
}

/// A number of 32 bits; throws what a wrong type throws for any other value.
struct NoId {};
/// Throws `NoId` for what is no whole number of 32 bits.
std::uint32_t id_of(const json& value) {
  const auto n = value.is_number_unsigned() ? value.get<std::uint64_t>() : ~std::uint64_t(0);
  if (n > 0xffffffffu) throw NoId();
  return static_cast<std::uint32_t>(n);
}

std::string type_of(const std::filesystem::path& file) {
  const std::string e = file.extension().string();
  if (e == ".js") return "text/javascript; charset=utf-8";
  if (e == ".css") return "text/css; charset=utf-8";
  if (e == ".html") return "text/html; charset=utf-8";
  if (e == ".json") return "application/json";
  if (e == ".svg") return "image/svg+xml";
  return "application/octet-stream";
}

}  // namespace

struct FoxgloveServer::Impl {
  class Client;

  explicit Impl(ServerOptions o) : options(std::move(o)), acceptor(io) {
    beast::error_code error;
    const auto address = asio::ip::make_address(options.address, error);
    if (error) throw ServerError("live view: " + options.address + " is no address");
    const tcp::endpoint end(address, options.port);
    acceptor.open(end.protocol(), error);
    if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor.bind(end, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error)
      throw ServerError("live view: cannot listen at " + options.address + ":" +
                        std::to_string(options.port) + ": " + error.message());
    port = acceptor.local_endpoint().port();
  }

  [[nodiscard]] bool host_allowed(std::string_view host) const {
    const std::string end = ":" + std::to_string(port);
    for (const std::string& name : {std::string("127.0.0.1"), std::string("localhost"), options.address})
      if (host == name + end || (port == 80 && host == name)) return true;
    return false;
  }
  [[nodiscard]] bool origin_allowed(std::string_view origin) const {
    if (origin.empty() || origin == "https://app.foxglove.dev") return true;
    constexpr std::string_view scheme = "http://";
    return origin.starts_with(scheme) && host_allowed(origin.substr(scheme.size()));
  }

  void accept();
  [[nodiscard]] bool make_room(bool of_stream);
  void deliver(std::uint32_t channel, const Shared& message);
  [[nodiscard]] json parameters_json(const json* names) const;
  void tell_parameter(const std::string& name);

  ServerOptions options;
  asio::io_context io{1};
  tcp::acceptor acceptor;
  std::uint16_t port = 0;
  std::vector<Channel> channels;
  std::unique_ptr<std::atomic<std::uint32_t>[]> subscribers;
  std::vector<Shared> latest;  // of latched channels; the server's thread only
  std::vector<Service> services;
  std::vector<Parameter> parameters;
  std::vector<Inlet> inlets;
  std::set<std::shared_ptr<Client>> clients;
  std::uint64_t accepted = 0;  ///< connections until now
  std::atomic<std::uint64_t> connected{0}, sent{0}, dropped{0}, refused{0}, nonsense{0};
  std::atomic<std::size_t> waiting{0};  // bytes handed to the thread and not yet taken up
  std::thread thread;
};

/// One connection: a request for a file, or a stream.
class FoxgloveServer::Impl::Client : public std::enable_shared_from_this<Client> {
 public:
  Client(Impl& server, tcp::socket socket)
      : number(server.accepted++), server_(server), stream_(std::move(socket)) {}

  void run() {
    beast::get_lowest_layer(stream_).expires_after(request_time);
    parser_.emplace();
    parser_->header_limit(8192);
    // The header only: no request here has a body, and Beast's reading of chunks (1.74) has assertions that
    // hostile bytes reach.
    http::async_read_header(stream_.next_layer(), buffer_, *parser_,
                            [self = shared_from_this()](beast::error_code e, std::size_t) {
                              if (e) return self->leave();
                              self->request();
                            });
  }
  void send(std::uint32_t channel, const Shared& message) {
    for (const auto& [subscription, of] : subscriptions_) {
      if (of != channel) continue;
      auto whole = std::make_shared<Bytes>(*message);
      std::memcpy(whole->data() + 1, &subscription, sizeof subscription);
      if (push({true, std::move(whole)})) {
        server_.sent.fetch_add(1, std::memory_order_relaxed);
      } else {
        server_.dropped.fetch_add(1, std::memory_order_relaxed);
      }
    }
  }
  void say(const json& text) {
    const std::string dump = text.dump(-1, ' ', false, json::error_handler_t::replace);
    static_cast<void>(push({false, std::make_shared<Bytes>(dump.begin(), dump.end())}));
  }
  [[nodiscard]] bool hears_parameters(const std::string& name) const {
    return all_parameters_ || parameters_.count(name) > 0;
  }
  void close() {
    beast::error_code ignored;
    beast::get_lowest_layer(stream_).socket().close(ignored);
  }
  /// Whether a newcomer is more important: a stream that subscribes to nothing, or a request that is not
  /// whole yet.
  [[nodiscard]] bool gives_way(bool streams) const {
    return streams ? open_ && subscriptions_.empty() && publications_.empty() : !asked_;
  }
  void leave() {
    if (open_) {
      open_ = false;
      server_.connected.fetch_sub(1);
      for (const auto& [id, channel] : subscriptions_) server_.subscribers[channel].fetch_sub(1);
      subscriptions_.clear();
      for (const auto& [id, inlet] : publications_) server_.inlets[inlet].left();
      publications_.clear();
    }
    close();
    server_.clients.erase(shared_from_this());
  }

  const std::uint64_t number;  ///< in the order of connecting

 private:
  struct Message {
    bool binary = true;
    Shared bytes;
  };

  /// An HTTP request: a file, or the change to a stream.
  void request() {
    asked_ = true;
    const auto& r = parser_->get();
    const auto field = [&](http::field name) {
      const auto v = r[name];
      return std::string_view(v.data(), v.size());
    };
    if (!server_.host_allowed(field(http::field::host)) ||
        !server_.origin_allowed(field(http::field::origin)))
      return refuse(http::status::forbidden, "this server answers its own page only\n");
    if (parser_->chunked() || parser_->content_length().value_or(0) > 0)
      return refuse(http::status::bad_request, "no request here has a body\n");
    if (!websocket::is_upgrade(r)) return file(std::string(r.target().data(), r.target().size()), r.method());
    std::string chosen;
    std::string_view offered = field(http::field::sec_websocket_protocol);
    for (const char* p : protocols)
      for (const auto& token : http::token_list(beast::string_view(offered.data(), offered.size())))
        if (chosen.empty() && token == p) chosen = p;
    if (chosen.empty())
      return refuse(http::status::bad_request, "sub-protocol: foxglove.sdk.v1 or foxglove.websocket.v1\n");
    if (server_.connected.load() >= server_.options.clients && !server_.make_room(true))
      return refuse(http::status::service_unavailable, "too many clients\n");
    beast::get_lowest_layer(stream_).expires_never();
    stream_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    stream_.set_option(websocket::stream_base::decorator([chosen](websocket::response_type& reply) {
      reply.set(http::field::sec_websocket_protocol, chosen);
    }));
    stream_.read_message_max(largest_request);
    stream_.auto_fragment(false);
    stream_.async_accept(r, [self = shared_from_this()](beast::error_code e) {
      if (e) return self->leave();
      self->begin();
    });
  }
  void refuse(http::status status, const char* words) {
    server_.refused.fetch_add(1, std::memory_order_relaxed);
    reply(status, "text/plain; charset=utf-8", words);
  }
  void reply(http::status status, const std::string& type, std::string body) {
    reply_.emplace(status, parser_->get().version());
    reply_->set(http::field::content_type, type);
    reply_->set(http::field::cache_control, "no-cache");
    reply_->set("X-Content-Type-Options", "nosniff");
    reply_->set("X-Frame-Options", "SAMEORIGIN");
    reply_->keep_alive(false);
    reply_->body() = std::move(body);
    reply_->prepare_payload();
    http::async_write(
        stream_.next_layer(), *reply_, [self = shared_from_this()](beast::error_code, std::size_t) {
          beast::error_code ignored;
          beast::get_lowest_layer(self->stream_).socket().shutdown(tcp::socket::shutdown_send, ignored);
          self->leave();
        });
  }
  void file(std::string target, http::verb method) {
    if (method != http::verb::get) return reply(http::status::method_not_allowed, "text/plain", "GET only\n");
    target = target.substr(0, target.find('?'));
    if (const auto found = server_.options.files.find(target); found != server_.options.files.end())
      return reply(http::status::ok, found->second.type, found->second.bytes);
    for (const auto& [prefix, folder] : server_.options.folders) {
      if (!target.starts_with(prefix)) continue;
      // Letters, digits, `_`, `-`, single dots and slashes: no way out of the folder.
      const std::string rest = target.substr(prefix.size());
      bool plain = !rest.empty() && rest.find("..") == std::string::npos && rest.front() != '/';
      for (const char c : rest)
        plain = plain && ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          c == '_' || c == '-' || c == '.' || c == '/');
      const std::filesystem::path path = std::filesystem::path(folder) / rest;
      std::error_code error;
      if (plain && std::filesystem::is_regular_file(path, error)) {
        std::ifstream in(path, std::ios::binary);
        return reply(http::status::ok, type_of(path), std::string(std::istreambuf_iterator<char>(in), {}));
      }
    }
    reply(http::status::not_found, "text/plain", "no such file\n");
  }

  void begin() {
    open_ = true;
    server_.connected.fetch_add(1);
    const bool control = server_.options.allow_control;
    json capabilities = json::array({"services"});
    if (!server_.parameters.empty())
      capabilities.insert(capabilities.end(), {"parameters", "parametersSubscribe"});
    if (!server_.inlets.empty()) capabilities.push_back("clientPublish");
    json metadata = {{"control", control ? "allowed" : "refused"}};
    for (const Parameter& p : server_.parameters)  // the protocol has no ranges
      metadata["range of " + p.name] = json::array({p.lower, p.upper}).dump();
    for (const Inlet& i : server_.inlets)
      metadata["takes " + i.topic] = "json";  // nor names of what it takes
    say({{"op", "serverInfo"},
         {"name", server_.options.name},
         {"capabilities", capabilities},
         {"supportedEncodings", {"cdr", "json"}},
         {"metadata", metadata}});
    json topics = json::array();
    for (std::size_t i = 0; i < server_.channels.size(); ++i) {
      const Channel& c = server_.channels[i];
      json one = {{"id", i + 1},
                  {"topic", c.topic},
                  {"encoding", c.encoding},
                  {"schemaName", c.schema_name},
                  {"schema", c.schema}};
      if (!c.schema_encoding.empty()) one["schemaEncoding"] = c.schema_encoding;
      topics.push_back(std::move(one));
    }
    say({{"op", "advertise"}, {"channels", topics}});
    json offered = json::array();
    for (std::size_t i = 0; i < server_.services.size(); ++i) {
      const json request = {{"encoding", "cdr"},
                            {"schemaName", "std_srvs/srv/Trigger_Request"},
                            {"schemaEncoding", "ros2msg"},
                            {"schema", ""}};
      const json response = {{"encoding", "cdr"},
                             {"schemaName", "std_srvs/srv/Trigger_Response"},
                             {"schemaEncoding", "ros2msg"},
                             {"schema", "bool success\nstring message\n"}};
      offered.push_back({{"id", i + 1},
                         {"name", server_.services[i].name},
                         {"type", "std_srvs/srv/Trigger"},
                         {"request", request},
                         {"response", response}});
    }
    say({{"op", "advertiseServices"}, {"services", offered}});
    read();
  }
  void read() {
    buffer_.clear();
    stream_.async_read(buffer_, [self = shared_from_this()](beast::error_code e, std::size_t) {
      if (e) return self->leave();
      const auto data = self->buffer_.cdata();
      const std::span<const unsigned char> bytes(static_cast<const unsigned char*>(data.data()), data.size());
      if (self->stream_.got_text()) {
        self->text(bytes);
      } else {
        self->binary(bytes);
      }
      self->read();
    });
  }
  void complain(const std::string& words) {
    server_.nonsense.fetch_add(1, std::memory_order_relaxed);
    say({{"op", "status"}, {"level", 2}, {"message", words}});
  }
  void text(std::span<const unsigned char> bytes) {
    const json m = json::parse(bytes.begin(), bytes.end(), nullptr, false);
    if (!m.is_object() || !m.contains("op") || !m["op"].is_string()) return complain("no JSON with an op");
    const std::string op = m["op"];
    try {
      if (op == "subscribe") return subscribe(m.at("subscriptions"));
      if (op == "unsubscribe") {
        for (const json& id : m.at("subscriptionIds")) unsubscribe(id_of(id));
        return;
      }
      if (op == "getParameters") {
        json out = {{"op", "parameterValues"},
                    {"parameters", server_.parameters_json(&m.at("parameterNames"))}};
        if (m.contains("id") && m["id"].is_string()) out["id"] = m["id"];
        return say(out);
      }
      if (op == "setParameters") return set_parameters(m);
      if (op == "advertise") return publishes(m.at("channels"));
      if (op == "unadvertise") {
        for (const json& id : m.at("channelIds")) publishes_no_more(id_of(id));
        return;
      }
      if (op == "subscribeParameterUpdates" || op == "unsubscribeParameterUpdates") {
        const json& names = m.at("parameterNames");
        const bool on = op == "subscribeParameterUpdates";
        if (names.empty()) all_parameters_ = on;
        for (const Parameter& p : server_.parameters)
          for (const json& name : names)
            if (name.get<std::string>() == p.name) {
              if (on) {
                parameters_.insert(p.name);
              } else {
                parameters_.erase(p.name);
              }
            }
        return;
      }
      complain("op " + op.substr(0, 40) + " is not offered");
    } catch (const json::exception&) {
      complain("op " + op.substr(0, 40) + ": a member is missing or of a wrong type");
    } catch (const NoId&) {
      complain("op " + op.substr(0, 40) + ": an id is no whole number of 32 bits");
    }
  }
  void subscribe(const json& wanted) {
    for (const json& s : wanted) {
      const auto id = id_of(s.at("id"));
      const auto channel = id_of(s.at("channelId"));
      if (channel < 1 || channel > server_.channels.size() || subscriptions_.count(id) > 0 ||
          subscriptions_.size() >= most_subscriptions) {
        complain("subscription " + std::to_string(id) + " to channel " + std::to_string(channel) +
                 " cannot be");
        continue;
      }
      const auto index = static_cast<std::uint32_t>(channel - 1);
      subscriptions_[id] = index;
      server_.subscribers[index].fetch_add(1);
      if (const Shared& last = server_.latest[index]; server_.channels[index].latched && last) {
        auto whole = std::make_shared<Bytes>(*last);
        std::memcpy(whole->data() + 1, &id, sizeof id);
        static_cast<void>(push({true, std::move(whole)}));
        server_.sent.fetch_add(1, std::memory_order_relaxed);
      }
    }
  }
  void unsubscribe(std::uint32_t id) {
    const auto found = subscriptions_.find(id);
    if (found == subscriptions_.end()) return complain("no subscription " + std::to_string(id));
    server_.subscribers[found->second].fetch_sub(1);
    subscriptions_.erase(found);
  }
  void publishes(const json& offered) {
    for (const json& c : offered) {
      const auto id = id_of(c.at("id"));
      const auto topic = c.at("topic").get<std::string>();
      const auto& all = server_.inlets;
      const auto found =
          std::find_if(all.begin(), all.end(), [&](const Inlet& i) { return i.topic == topic; });
      if (found == all.end() || c.at("encoding") != "json" || publications_.count(id) > 0 ||
          publications_.size() >= most_subscriptions) {
        complain("topic " + topic.substr(0, 40) + " cannot be published to as channel " + std::to_string(id));
        continue;
      }
      publications_[id] = static_cast<std::size_t>(found - all.begin());
    }
  }
  void publishes_no_more(std::uint32_t id) {
    const auto found = publications_.find(id);
    if (found == publications_.end()) return complain("no channel " + std::to_string(id));
    server_.inlets[found->second].left();
    publications_.erase(found);
  }
  void published(std::span<const unsigned char> b) {
    const auto found =
        b.size() < 5 ? publications_.end() : publications_.find(number_at<std::uint32_t>(b, 1));
    if (found == publications_.end()) return complain("a message on a channel that was not advertised");
    const Inlet& inlet = server_.inlets[found->second];
    const Answer answer = inlet.take({reinterpret_cast<const char*>(b.data()) + 5, b.size() - 5});
    if (!answer.done) return complain("a message on " + inlet.topic + " was not understood");
    if (!answer.words.empty())
      say({{"op", "status"}, {"level", 0}, {"message", answer.words}, {"id", inlet.topic}});
  }
  void set_parameters(const json& m) {
    json names = json::array();
    for (const json& p : m.at("parameters")) {
      const auto name = p.at("name").get<std::string>();
      names.push_back(name);
      for (Parameter& mine : server_.parameters) {
        if (mine.name != name) continue;
        if (!server_.options.allow_control || !mine.set) {
          complain("parameter " + name + " is not to be set: control is not allowed");
          continue;
        }
        const auto value = p.at("value").get<double>();
        if (!(value >= mine.lower && value <= mine.upper)) {
          complain("parameter " + name + ": " + std::to_string(value) + " is not within " +
                   std::to_string(mine.lower) + " to " + std::to_string(mine.upper));
          continue;
        }
        mine.value = value;
        mine.set(value);
        server_.tell_parameter(name);
      }
    }
    if (m.contains("id") && m["id"].is_string())
      say({{"op", "parameterValues"}, {"parameters", server_.parameters_json(&names)}, {"id", m["id"]}});
  }
  void binary(std::span<const unsigned char> b) {
    if (!b.empty() && b[0] == 1) return published(b);
    if (b.size() < 13 || b[0] != 2)
      return complain("a binary message that is no service call and no message");
    const auto service = number_at<std::uint32_t>(b, 1), call = number_at<std::uint32_t>(b, 5),
               length = number_at<std::uint32_t>(b, 9);
    const auto fails = [&](const std::string& words) {
      server_.nonsense.fetch_add(1, std::memory_order_relaxed);
      say({{"op", "serviceCallFailure"}, {"serviceId", service}, {"callId", call}, {"message", words}});
    };
    if (service < 1 || service > server_.services.size()) return fails("no such service");
    if (length > b.size() - 13 ||
        std::string_view(reinterpret_cast<const char*>(b.data()) + 13, length) != "cdr")
      return fails("the request is not in CDR");
    const Service& s = server_.services[service - 1];
    const Answer answer = s.controls && !server_.options.allow_control
                              ? Answer{false, "control is not allowed: start with --allow-control"}
                              : s.called();
    Bytes out{3};
    put(out, service), put(out, call), put(out, std::uint32_t(3));
    for (const char c : {'c', 'd', 'r'}) out.push_back(static_cast<unsigned char>(c));
    const Bytes response = trigger_response(answer);
    out.insert(out.end(), response.begin(), response.end());
    static_cast<void>(push({true, std::make_shared<Bytes>(std::move(out))}, true));
  }

  /// False: too much waits for this client already.
  ///
  /// @param at_once  before all that waits, and beside it: an answer to a person.
  bool push(Message m, bool at_once = false) {
    if (!open_) return false;
    const std::size_t size = m.bytes->size();
    if (queued_ + size > (at_once ? 2 : 1) * server_.options.queued) return false;
    queued_ += size;
    queue_.insert(at_once && !queue_.empty() ? queue_.begin() + 1 : queue_.end(), std::move(m));
    if (queue_.size() == 1) write();
    return true;
  }
  void write() {
    stream_.binary(queue_.front().binary);
    stream_.async_write(asio::buffer(*queue_.front().bytes),
                        [self = shared_from_this()](beast::error_code e, std::size_t) {
                          if (e) return self->leave();
                          self->queued_ -= self->queue_.front().bytes->size();
                          self->queue_.pop_front();
                          if (!self->queue_.empty()) self->write();
                        });
  }
  Impl& server_;
  websocket::stream<beast::tcp_stream> stream_;
  beast::flat_buffer buffer_{largest_request + 8192};
  std::optional<http::request_parser<http::string_body>> parser_;
  std::optional<http::response<http::string_body>> reply_;
  std::map<std::uint32_t, std::uint32_t> subscriptions_;
  std::map<std::uint32_t, std::size_t> publications_;  ///< to which inlet
  std::set<std::string> parameters_;
  bool all_parameters_ = false, open_ = false;
  bool asked_ = false;  ///< its request is whole
  std::deque<Message> queue_;
  std::size_t queued_ = 0;
};

void FoxgloveServer::Impl::accept() {
  acceptor.async_accept(io, [this](beast::error_code e, tcp::socket socket) {
    if (e == asio::error::operation_aborted) return;
    if (!e) {
      socket.set_option(tcp::no_delay(true), e);
      if (clients.size() < 2 * options.clients + 16 ||
          make_room(false)) {  // those that only ask for files as well
        auto client = std::make_shared<Client>(*this, std::move(socket));
        clients.insert(client);
        client->run();
      } else {
        refused.fetch_add(1);
      }
    }
    accept();
  });
}

/// Ends the oldest connection that gives way, so that nobody keeps a person's Stop out by connections that
/// ask for nothing.
bool FoxgloveServer::Impl::make_room(bool of_stream) {
  std::shared_ptr<Client> oldest;
  for (const auto& client : clients)
    if (client->gives_way(of_stream) && (!oldest || client->number < oldest->number)) oldest = client;
  if (!oldest) return false;
  refused.fetch_add(1);
  oldest->leave();
  return true;
}

void FoxgloveServer::Impl::deliver(std::uint32_t channel, const Shared& message) {
  if (channels[channel].latched) latest[channel] = message;
  const auto now = clients;  // a client that leaves is erased
  for (const auto& client : now) client->send(channel, message);
}

json FoxgloveServer::Impl::parameters_json(const json* names) const {
  json out = json::array();
  for (const Parameter& p : parameters) {
    bool asked = names == nullptr || names->empty();
    if (names != nullptr)
      for (const json& name : *names) asked = asked || name == p.name;
    if (asked) out.push_back({{"name", p.name}, {"value", p.value}, {"type", "float64"}});
  }
  return out;
}

void FoxgloveServer::Impl::tell_parameter(const std::string& name) {
  const json names = json::array({name});
  const json text = {{"op", "parameterValues"}, {"parameters", parameters_json(&names)}};
  const auto now = clients;
  for (const auto& client : now)
    if (client->hears_parameters(name)) client->say(text);
}

FoxgloveServer::FoxgloveServer(ServerOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {}
FoxgloveServer::~FoxgloveServer() {
  stop();
}

std::uint16_t FoxgloveServer::port() const noexcept {
  return impl_->port;
}
std::string FoxgloveServer::url() const {
  return "http://" + impl_->options.address + ":" + std::to_string(impl_->port) + "/";
}
std::uint32_t FoxgloveServer::add(Channel channel) {
  impl_->channels.push_back(std::move(channel));
  return static_cast<std::uint32_t>(impl_->channels.size() - 1);
}
void FoxgloveServer::add(Service service) {
  impl_->services.push_back(std::move(service));
}
void FoxgloveServer::add(Parameter parameter) {
  impl_->parameters.push_back(std::move(parameter));
}
void FoxgloveServer::add(Inlet inlet) {
  impl_->inlets.push_back(std::move(inlet));
}

void FoxgloveServer::start() {
  Impl& i = *impl_;
  i.subscribers = std::make_unique<std::atomic<std::uint32_t>[]>(i.channels.size());
  i.latest.resize(i.channels.size());
  i.accept();
  i.thread = std::thread([&i] { i.io.run(); });
}
bool FoxgloveServer::wanted(std::uint32_t channel) const noexcept {
  return impl_->channels[channel].latched || impl_->subscribers[channel].load(std::memory_order_relaxed) > 0;
}
void FoxgloveServer::publish(std::uint32_t channel, skinctl::Nanoseconds time,
                             std::span<const unsigned char> message) {
  Impl& i = *impl_;
  if (!wanted(channel)) return;
  // What the thread has not taken up yet is bounded as well.
  if (i.waiting.load() > 16 * i.options.queued) {
    i.dropped.fetch_add(1);
    return;
  }
  auto whole = std::make_shared<Bytes>();
  whole->reserve(13 + message.size());
  put(*whole, std::uint8_t(1)), put(*whole, std::uint32_t(0)),
      put(*whole, static_cast<std::uint64_t>(time.count()));
  whole->insert(whole->end(), message.begin(), message.end());
  const std::size_t size = whole->size();
  i.waiting.fetch_add(size);
  asio::post(i.io, [&i, channel, size, message = Shared(std::move(whole))] {
    i.waiting.fetch_sub(size);
    i.deliver(channel, message);
  });
}
void FoxgloveServer::set_parameter(const std::string& name, double value) {
  Impl& i = *impl_;
  asio::post(i.io, [&i, name, value] {
    for (Parameter& p : i.parameters)
      if (p.name == name) p.value = value;
    i.tell_parameter(name);
  });
}
ServerStatistics FoxgloveServer::statistics() const noexcept {
  const Impl& i = *impl_;
  return {i.connected.load(), i.sent.load(), i.dropped.load(), i.refused.load(), i.nonsense.load()};
}
void FoxgloveServer::stop(const std::string& words) noexcept {
  Impl& i = *impl_;
  if (!i.thread.joinable()) return;
  asio::steady_timer sent(i.io);
  asio::post(i.io, [&] {
    beast::error_code ignored;
    i.acceptor.close(ignored);
    const auto now = i.clients;
    for (const auto& client : now)
      if (!words.empty()) client->say({{"op", "status"}, {"level", 1}, {"message", words}, {"id", "ended"}});
    sent.expires_after(std::chrono::milliseconds(words.empty() ? 0 : 100));
    sent.async_wait([&i, now](beast::error_code) {
      for (const auto& client : now) client->close();
      i.io.stop();
    });
  });
  i.thread.join();
  i.clients.clear();
}

}  // namespace adapters::live
