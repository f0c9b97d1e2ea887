// The live view's server against clients written here byte by byte: hand-shake, hosts and origins, messages,
// services, parameters, nonsense, clients that do not read.
//
// Promise: a live page shows what runs and cannot be misused
// Tried: hosts, origins and sub-protocols of others refused; stop at once, resume and weights only with
// consent, a weight refused goes back; scrubbing, whole, cut and rubbish files; nothing overflows at 360
// and 1400 points; any two colours 12 apart (CIE76) to normal eyes and to three kinds of dichromats.
// Also: `examples/live_page/tests/page_in_browser.cpp`
//
// Promise: hostile frames end who sent them, and nobody else
// Tried: nonsense in JSON and binary, 60 random connections, no UTF-8: answered or ended; 20 of 20
// messages to the neighbour
//
// Promise: slow clients lose messages, which are counted, and delay nobody
// Tried: one that does not read: its neighbour 0 of 400; 20 that do: all of 1000; 20 that do not: 2000
// messages of half a megabyte counted, a call of `publish` under 2 ms

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "examples/adapters/live/foxglove_server.hpp"
#include "examples/live_page/tests/byte_client.hpp"
#include "skinctl/testing/random.hpp"

using namespace adapters;
using namespace adapters::live;
using live_page::call_of;
using live_page::Client;
using nlohmann::json;
using namespace std::chrono_literals;

namespace {

struct Served {
  explicit Served(bool control = true, std::size_t queued = std::size_t(1) << 20, std::size_t clients = 32) {
    ServerOptions o;
    o.allow_control = control;
    o.queued = queued;
    o.clients = clients;
    o.files["/"] = {"text/html; charset=utf-8", "<p>page</p>"};
    o.folders["/folder/"] = "/usr/include";
    server = std::make_unique<FoxgloveServer>(std::move(o));
    channel = server->add({"/a", "cdr", "std_msgs/msg/String", "string data\n", "ros2msg", false});
    latched = server->add({"/b", "cdr", "std_msgs/msg/String", "string data\n", "ros2msg", true});
    server->add(Service{"/stop", false, [this] { return ++stops, Answer{true, "stopped"}; }});
    server->add(Service{"/resume", true, [this] { return ++resumes, Answer{true, "resumed"}; }});
    server->add(Parameter{"weight", 0.25, 0, 1, [this](double w) { weight = w; }});
    server->start();
    host = "127.0.0.1:" + std::to_string(server->port());
  }
  [[nodiscard]] std::string handshake(const std::string& more = {}) const {
    return Client::get("/", host, Client::upgrade("foxglove.websocket.v1", more));
  }
  /// A client that has heard what is offered.
  std::unique_ptr<Client> connected(json* channels = nullptr) const {
    auto c = std::make_unique<Client>(server->port());
    REQUIRE(c->send(handshake()));
    REQUIRE(c->reply().find("101") != std::string::npos);
    const json info = c->text("serverInfo");
    CHECK(info["supportedEncodings"][0] == "cdr");
    const json offered = c->text("advertise");
    if (channels != nullptr) *channels = offered["channels"];
    CHECK(c->text("advertiseServices")["services"].size() == 2);
    return c;
  }
  void publish(std::uint32_t to, const std::string& bytes, skinctl::Nanoseconds time = 1500ms) {
    server->publish(to, time, {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
  }
  bool until(auto&& what) const {
    for (int k = 0; k < 400; ++k, std::this_thread::sleep_for(10ms))
      if (what()) return true;
    return false;
  }
  std::unique_ptr<FoxgloveServer> server;
  std::uint32_t channel = 0, latched = 0;
  std::atomic<int> stops{0}, resumes{0};
  std::atomic<double> weight{-1};
  std::string host;
};

}  // namespace

TEST_CASE("FoxgloveServer: the page, and nothing outside its folders") {
  const Served s;
  const auto status = [&](const std::string& path) {
    Client c(s.server->port());
    REQUIRE(c.send(Client::get(path, s.host)));
    const std::string r = c.reply(true);
    return r.substr(9, 3) + (r.find("\r\n\r\n") == std::string::npos ? "" : r.substr(r.find("\r\n\r\n") + 4));
  };
  CHECK(status("/") == "200<p>page</p>");
  CHECK(status("/?x=1") == "200<p>page</p>");
  CHECK(status("/folder/stdio.h").size() > 1000);
  for (const char* path : {"/folder/../../etc/passwd", "/folder//etc/passwd", "/folder/..%2f..%2fetc/passwd",
                           "/folder/", "/nothing", "/folder/a..b", "/folder/bits"})
    CHECK(status(path).substr(0, 3) == "404");
}

TEST_CASE("FoxgloveServer: other hosts, origins and sub-protocols are refused") {
  const Served s;
  const auto status = [&](const std::string& request) {
    Client c(s.server->port());
    REQUIRE(c.send(request));
    return c.reply().substr(9, 3);
  };
  const std::string port = std::to_string(s.server->port());
  CHECK(status(s.handshake()) == "101");
  CHECK(status(s.handshake("Origin: http://127.0.0.1:" + port + "\r\n")) == "101");
  CHECK(status(s.handshake("Origin: http://localhost:" + port + "\r\n")) == "101");
  CHECK(status(s.handshake("Origin: https://app.foxglove.dev\r\n")) == "101");
  for (const std::string& origin :
       {std::string("http://evil.example"), "http://127.0.0.1.evil.example:" + port, std::string("null"),
        "https://127.0.0.1:" + port, std::string("http://127.0.0.1:1")})
    CHECK(status(s.handshake("Origin: " + origin + "\r\n")) == "403");
  for (const std::string& host :
       {std::string("evil.example"), "evil.example:" + port, std::string("127.0.0.1:1"), std::string()})
    CHECK(status(Client::get("/", host, Client::upgrade("foxglove.websocket.v1"))) == "403");
  CHECK(status(Client::get("/", s.host, Client::upgrade(""))) == "400");
  CHECK(status(Client::get("/", s.host, Client::upgrade("chat"))) == "400");
  CHECK(status(Client::get("/", s.host, Client::upgrade("chat, foxglove.sdk.v1"))) == "101");
  CHECK(s.until([&] { return s.server->statistics().refused == 11; }));
}

TEST_CASE(
    "FoxgloveServer: the hand-shake of RFC 6455, topics, messages as they are documented, latched ones at "
    "once") {
  Served s;
  {
    Client c(s.server->port());
    REQUIRE(c.send(s.handshake()));
    CHECK(c.reply().find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") != std::string::npos);
  }
  s.publish(s.latched, "before");
  json channels;
  const auto c = s.connected(&channels);
  REQUIRE(channels.size() == 2);
  CHECK(channels[0]["topic"] == "/a");
  CHECK(channels[0]["schemaEncoding"] == "ros2msg");
  CHECK(!s.server->wanted(s.channel));
  CHECK(c->say(
      {{"op", "subscribe"},
       {"subscriptions",
        {{{"id", 7}, {"channelId", channels[0]["id"]}}, {{"id", 9}, {"channelId", channels[1]["id"]}}}}}));
  // 01, the subscription, the time in nanoseconds, the bytes.
  CHECK(c->binary() == std::string("\1\11\0\0\0\0\x2f\x68\x59\0\0\0\0before", 19));
  REQUIRE(s.until([&] { return s.server->wanted(s.channel); }));
  s.publish(s.channel, "now");
  CHECK(c->binary() == std::string("\1\7\0\0\0\0\x2f\x68\x59\0\0\0\0now", 16));
  CHECK(c->say({{"op", "unsubscribe"}, {"subscriptionIds", {7}}}));
  CHECK(s.until([&] { return !s.server->wanted(s.channel); }));
}

TEST_CASE("FoxgloveServer: services and parameters, with and without consent") {
  for (const bool control : {true, false}) {
    CAPTURE(control);
    Served s(control);
    const auto c = s.connected();
    for (const std::uint32_t service : {1u, 2u}) {
      REQUIRE(c->frame(2, call_of(service, 40 + service)));
      const std::string reply = c->binary();
      const bool done = service == 1 || control;
      REQUIRE(reply.size() > 29);
      CHECK(reply[0] == 3);
      CHECK(static_cast<unsigned>(reply[1]) == service);
      CHECK(static_cast<unsigned>(reply[5]) == 40 + service);
      CHECK(reply.substr(9, 7) == std::string("\3\0\0\0cdr", 7));
      CHECK(reply.substr(16, 4) == std::string("\0\1\0\0", 4));
      CHECK((reply[20] == 1) == done);
      std::uint32_t length = 0;
      std::memcpy(&length, reply.data() + 24, 4);
      CHECK(length == reply.size() - 28);
      CHECK(reply.back() == '\0');
    }
    CHECK(s.stops == 1);
    CHECK(s.resumes == (control ? 1 : 0));
    CHECK(c->say({{"op", "subscribeParameterUpdates"}, {"parameterNames", {"weight"}}}));
    CHECK(c->say(
        {{"op", "setParameters"}, {"parameters", {{{"name", "weight"}, {"value", 0.5}}}}, {"id", "x"}}));
    if (control) {
      CHECK(c->text("parameterValues")["parameters"][0]["value"] == 0.5);
      CHECK(s.weight == 0.5);
      CHECK(c->text("parameterValues")["id"] == "x");
      CHECK(c->say({{"op", "setParameters"}, {"parameters", {{{"name", "weight"}, {"value", 1.5}}}}}));
      CHECK(c->text("status")["message"].get<std::string>().find("1.5") != std::string::npos);
      CHECK(s.weight == 0.5);
    } else {
      CHECK(c->text("status")["level"] == 2);
      CHECK(s.weight == -1);
    }
    s.server->set_parameter("weight", 0.75);
    for (json m = c->text("parameterValues"); m["parameters"][0]["value"] != 0.75;
         m = c->text("parameterValues"))
      REQUIRE(!m.is_null());
  }
}

TEST_CASE("FoxgloveServer: clients publish to the topics that the job takes, and to no other") {
  ServerOptions o;
  FoxgloveServer server(std::move(o));
  std::atomic<int> taken{0}, refused{0}, left{0};
  server.add(Inlet{"/finger",
                   [&](std::string_view m) {
                     ++(m == "{}" ? taken : refused);
                     return Answer{m == "{}", "pressed"};
                   },
                   [&] { ++left; }});
  server.start();
  const std::string host = "127.0.0.1:" + std::to_string(server.port());
  const auto connected = [&] {
    auto c = std::make_unique<Client>(server.port());
    REQUIRE(c->send(Client::get("/", host, Client::upgrade("foxglove.websocket.v1"))));
    REQUIRE(c->reply().find("101") != std::string::npos);
    const json info = c->text("serverInfo");
    CHECK(info["metadata"]["takes /finger"] == "json");
    CHECK(info["capabilities"].dump().find("clientPublish") != std::string::npos);
    return c;
  };
  const auto until = [](auto&& what) {
    for (int k = 0; k < 400 && !what(); ++k) std::this_thread::sleep_for(10ms);
    return what();
  };
  const auto message = [](std::uint32_t id, const std::string& text) {
    std::string out = "\1";
    for (unsigned k = 0; k < 4; ++k) out += static_cast<char>(id >> 8 * k & 0xff);
    return out + text;
  };
  auto c = connected();
  const auto advertise = [](std::uint32_t id, const char* topic, const char* encoding) {
    return json{{"op", "advertise"},
                {"channels", {{{"id", id}, {"topic", topic}, {"encoding", encoding}, {"schemaName", ""}}}}};
  };
  const auto complains = [&] { return c->text("status")["message"].get<std::string>(); };
  REQUIRE(c->frame(2, message(7, "{}")));  // before it is advertised
  CHECK(complains() == "a message on a channel that was not advertised");
  for (const auto& [topic, encoding] : {std::pair("/cmd_vel", "json"), {"/finger", "cdr"}}) {
    REQUIRE(c->say(advertise(7, topic, encoding)));
    CHECK(complains().find("cannot be published to") != std::string::npos);
  }
  REQUIRE(c->say(advertise(7, "/finger", "json")));
  REQUIRE(c->say(advertise(7, "/finger", "json")));  // twice
  CHECK(complains().find("cannot be published to") != std::string::npos);
  REQUIRE(c->frame(2, message(7, "{}")));
  const json told = c->text("status");
  CHECK(told["id"] == "/finger");
  CHECK(told["message"] == "pressed");
  REQUIRE(c->frame(2, message(8, "{}")));
  CHECK(complains() == "a message on a channel that was not advertised");
  CHECK(taken == 1);
  for (const std::string bad : {"", "\1\7", "\1\7\0\0"}) {  // cut
    REQUIRE(c->frame(2, bad));
    CHECK(!complains().empty());
  }
  REQUIRE(c->frame(2, message(7, "nonsense")));
  CHECK(complains() == "a message on /finger was not understood");
  CHECK(refused == 1);
  // Whoever goes takes its finger along, by words or without.
  auto other = connected();
  REQUIRE(other->say(advertise(1, "/finger", "json")));
  REQUIRE(other->frame(2, message(1, "{}")));
  CHECK(until([&] { return taken == 2; }));
  CHECK(left == 0);
  other.reset();
  CHECK(until([&] { return left == 1; }));
  REQUIRE(c->say({{"op", "unadvertise"}, {"channelIds", {7}}}));
  CHECK(until([&] { return left == 2; }));
  REQUIRE(c->say({{"op", "unadvertise"}, {"channelIds", {7}}}));
  CHECK(complains() == "no channel 7");
}

TEST_CASE("FoxgloveServer: nonsense is answered or ends that client only, and the others hear everything") {
  Served s;
  const auto good = s.connected();
  REQUIRE(good->say({{"op", "subscribe"}, {"subscriptions", {{{"id", 1}, {"channelId", 1}}}}}));
  REQUIRE(s.until([&] { return s.server->wanted(s.channel); }));
  const auto bad = s.connected();
  for (const std::string& text :
       {std::string("{"), std::string("[]"), std::string("{\"op\":7}"), std::string("{\"op\":\"subscribe\"}"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":99999999999999999999}]})"),
        std::string(R"({"op":"subscribe","subscriptions":7})"),
        std::string(R"({"op":"fetchAsset","uri":"file:///etc/passwd"})"),
        std::string(R"({"op":"setParameters","parameters":[{"name":"weight","value":"much"}]})"),
        std::string(5000, '[')}) {
    REQUIRE(bad->frame(1, text));
    CHECK(bad->text("status")["level"] == 2);
  }
  for (const std::string& bytes :
       {std::string(), std::string("\2"), std::string(13, '\2'), call_of(9, 1), call_of(1, 1, "json")})
    REQUIRE(bad->frame(2, bytes));
  CHECK(bad->text("serviceCallFailure")["callId"] == 0x02020202);
  CHECK(bad->text("serviceCallFailure")["message"] == "no such service");
  CHECK(s.stops == 0);
  REQUIRE(bad->frame(1, "{\"op\":\"\xff\xfe\"}"));  // no UTF-8: RFC 6455 ends the connection
  auto last = bad->next();
  while (last && last->op != 8) last = bad->next();
  CHECK(last.has_value());
  bad->stream.close();
  CHECK(s.until([&] { return s.server->statistics().clients == 1; }));
  // A body, whole and in a chunk that comes byte by byte: refused before it is read.
  for (const std::string& header :
       {std::string("Transfer-Encoding: chunked\r\n"), std::string("Content-Length: 5\r\n")}) {
    Client c(s.server->port());
    std::string bytes = Client::get("/", s.host, header);
    for (std::size_t k = 0; k < 3; ++k, bytes = k == 1 ? "0\r\n" : "\r") {
      static_cast<void>(c.send(bytes));
      std::this_thread::sleep_for(20ms);
    }
    CHECK(c.reply().rfind("HTTP/1.1 400", 0) == 0);
  }
  // Frames that are none, a message too long, half a request, random bytes.
  auto rng = skinctl::testing::seeded(12);
  for (int k = 0; k < 60; ++k) {
    Client c(s.server->port());
    std::string bytes = k % 3 == 0 ? "" : s.handshake();
    for (int i = 0; i < 300; ++i)
      bytes += static_cast<char>(static_cast<unsigned char>(skinctl::testing::uniform(rng, 0.0, 255.9)));
    if (k % 5 == 0) bytes.resize(bytes.size() / 3);
    static_cast<void>(c.send(bytes));
  }
  for (int k = 0; k < 20; ++k) s.publish(s.channel, std::to_string(k));
  for (int k = 0; k < 20; ++k) CHECK(good->binary().substr(13) == std::to_string(k));
}

TEST_CASE(
    "FoxgloveServer: who does not read loses messages and delays nobody; too many clients are refused") {
  Served s(true, 200'000, 3);
  const auto reads = s.connected(), sleeps = s.connected();
  for (Client* c : {reads.get(), sleeps.get()})
    REQUIRE(c->say({{"op", "subscribe"}, {"subscriptions", {{{"id", 1}, {"channelId", 1}}}}}));
  REQUIRE(s.until([&] { return s.server->wanted(s.channel); }));
  std::this_thread::sleep_for(100ms);
  const std::string large(20'000, 'x');
  int heard = 0;
  for (int k = 0; k < 400; ++k) {
    s.publish(s.channel, large);
    if (reads->binary().size() == 13 + large.size()) ++heard;
  }
  CHECK(heard == 400);
  CHECK(s.server->statistics().dropped > 100);
  // Data fill its queue: a person's Stop is answered all the same, and before what waits.
  REQUIRE(sleeps->frame(2, call_of(1, 7)));
  REQUIRE(s.until([&] { return s.stops == 1; }));
  std::string answer;
  for (int k = 0; k < 400 && (answer.empty() || answer[0] != 3); ++k) answer = sleeps->binary();
  REQUIRE(!answer.empty());
  CHECK(answer[0] == 3);
  for (int k = 0; k < 5; ++k) CHECK(sleeps->binary().size() == 13 + large.size());
  const auto third = s.connected();
  REQUIRE(third->say({{"op", "subscribe"}, {"subscriptions", {{{"id", 1}, {"channelId", 1}}}}}));
  REQUIRE(third->say({{"op", "getParameters"}, {"parameterNames", {"weight"}}, {"id", "x"}}));
  REQUIRE(third->text("parameterValues")["id"] == "x");
  Client fourth(s.server->port());
  REQUIRE(fourth.send(s.handshake()));
  CHECK(fourth.reply().substr(9, 3) == "503");
  // Who leaves makes room.
  third->stream.close();
  CHECK(s.until([&] { return s.server->statistics().clients == 2; }));
  static_cast<void>(s.connected());
  s.server->stop();
  s.server->stop();
}

TEST_CASE("FoxgloveServer: 80 half requests and 32 idle streams do not keep a person's Stop out") {
  Served s;
  std::vector<std::unique_ptr<Client>> idle;
  for (int k = 0; k < 32; ++k) idle.push_back(s.connected());
  for (int k = 0; k < 80; ++k) {
    idle.push_back(std::make_unique<Client>(s.server->port()));
    REQUIRE(idle.back()->send("GET / HTTP/1.1\r\nHost: "));
  }
  Client page(s.server->port());
  REQUIRE(page.send(Client::get("/", s.host)));
  CHECK(page.reply().substr(9, 3) == "200");
  const auto person = s.connected();
  REQUIRE(person->frame(2, call_of(1, 7)));
  CHECK(s.until([&] { return s.stops == 1; }));
}

TEST_CASE(
    "FoxgloveServer: twenty clients hear everything; what they do not take is counted, and delays nobody") {
  Served s;
  std::vector<std::unique_ptr<Client>> clients;
  for (int k = 0; k < 20; ++k) {
    clients.push_back(s.connected());
    REQUIRE(clients.back()->say({{"op", "subscribe"}, {"subscriptions", {{{"id", 1}, {"channelId", 1}}}}}));
    // It has subscribed once it is answered.
    REQUIRE(clients.back()->say({{"op", "getParameters"}, {"parameterNames", {"weight"}}, {"id", "x"}}));
    REQUIRE(clients.back()->text("parameterValues")["id"] == "x");
  }
  for (int k = 0; k < 50; ++k) s.publish(s.channel, std::to_string(k));
  for (const auto& client : clients)
    for (int k = 0; k < 50; ++k) REQUIRE(client->binary().substr(13) == std::to_string(k));
  CHECK(s.server->statistics().sent == 1000);
  CHECK(s.server->statistics().dropped == 0);
  // Nobody reads now: 50 MB for each, of which a queue of 1 MiB and the sockets' buffers hold a part.
  const std::string large(500'000, 'x');
  std::vector<double> times;
  for (int k = 0; k < 100; ++k) {
    const auto from = std::chrono::steady_clock::now();
    s.publish(s.channel, large);
    times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count());
    std::this_thread::sleep_for(2ms);
  }
  const auto counted = [&] {
    const auto told = s.server->statistics();
    return told.sent + told.dropped - 1000;
  };
  s.until([&] { return counted() >= 2000; });
  const std::uint64_t taken = s.server->statistics().sent - 1000;
  MESSAGE(taken << " of 2000 taken, " << s.server->statistics().dropped << " dropped");
  CHECK(s.server->statistics().dropped > 500);
  CHECK(s.server->statistics().clients == 20);
  std::nth_element(times.begin(), times.begin() + 50, times.end());
  CHECK(times[50] < 0.1);  // a copy of half a megabyte; who waited for these clients would wait for ever
}
