#include "examples/simulated_ur5/dashboard.hpp"

#include <doctest/doctest.h>

#include <memory>

#include "examples/simulated_ur5/random.hpp"
#include "examples/simulated_ur5/tests/raw.hpp"

using namespace simulated_ur5;

namespace {

struct Bench {
  explicit Bench(Series series = Series::e_series) {
    config.series = series;
    controller = std::make_unique<Controller>(config);
    programs["stream.urp"] = raw::stream_program(50001);
    session = std::make_unique<DashboardSession>(*controller, programs, panel);
  }
  std::string ask(const std::string& line) {
    std::string out;
    open = session->receive(raw::bytes(line + "\n"), out);
    REQUIRE(!out.empty());
    CHECK(out.back() == '\n');
    out.pop_back();
    return out;
  }
  void run(double t) {
    for (double s = 0; s < t; s += seconds(controller->cycle())) controller->step();
  }
  ControllerConfig config;
  std::unique_ptr<Controller> controller;
  ProgramLibrary programs;
  PanelState panel;
  std::unique_ptr<DashboardSession> session;
  bool open = true;
};

}  // namespace

TEST_CASE("Dashboard: the lines of the guide, from power off to a running program") {
  Bench b;
  CHECK(b.ask("robotmode") == "Robotmode: POWER_OFF");
  CHECK(b.ask("safetymode") == "Safetymode: NORMAL");
  CHECK(b.ask("safetystatus") == "Safetystatus: NORMAL");
  CHECK(b.ask("play") == "Failed to execute: play");
  CHECK(b.ask("power on") == "Powering on");
  b.run(2);
  CHECK(b.ask("robotmode") == "Robotmode: IDLE");
  CHECK(b.ask("brake release") == "Brake releasing");
  b.run(2);
  CHECK(b.ask("robotmode") == "Robotmode: RUNNING");
  CHECK(b.ask("get loaded program") == "No program loaded");
  CHECK(b.ask("load nothing.urp") == "File not found: nothing.urp");
  CHECK(b.ask("load stream.urp") == "Loading program: stream.urp");
  CHECK(b.ask("get loaded program") == "Loaded program: stream.urp");
  CHECK(b.ask("programState") == "STOPPED stream.urp");
  CHECK(b.ask("running") == "Program running: false");
  CHECK(b.ask("play") == "Starting program");
  b.run(0.1);
  CHECK(b.ask("programState") == "PLAYING stream.urp");
  CHECK(b.ask("running") == "Program running: true");
  CHECK(b.ask("pause") == "Pausing program");
  b.run(0.1);
  CHECK(b.ask("programState") == "PAUSED stream.urp");
  CHECK(b.ask("pause") == "Failed to execute: pause");
  CHECK(b.ask("play") == "Starting program");
  CHECK(b.ask("stop") == "Stopped");
  b.run(0.1);
  CHECK(b.ask("programState") == "STOPPED stream.urp");
  CHECK(b.ask("power off") == "Powering off");
  CHECK(b.ask("robotmode") == "Robotmode: POWER_OFF");
}

TEST_CASE("Dashboard: protective stops are told and unlocked after 5 s") {
  Bench b;
  b.ask("brake release");
  b.run(3);
  b.controller->protective_stop("test");
  CHECK(b.ask("safetymode") == "Safetymode: PROTECTIVE_STOP");
  CHECK(b.ask("unlock protective stop").find("Cannot unlock protective stop until 5s") == 0);
  CHECK(b.ask("close safety popup") == "closing safety popup");
  b.run(5.1);
  CHECK(b.ask("unlock protective stop") == "Protective stop releasing");
  CHECK(b.ask("safetymode") == "Safetymode: NORMAL");
  b.controller->emergency_stop();
  CHECK(b.ask("safetymode") == "Safetymode: ROBOT_EMERGENCY_STOP");
  CHECK(b.ask("power on") == "Failed to execute: power on");
  CHECK(b.ask("restart safety") == "Restarting safety");
  CHECK(b.ask("safetymode") == "Safetymode: NORMAL");
}

TEST_CASE("Dashboard: versions, models, small talk and the end") {
  Bench e, cb3(Series::cb3);
  CHECK(e.ask("PolyscopeVersion").find("URSoftware 5.") == 0);
  CHECK(cb3.ask("PolyscopeVersion").find("URSoftware 3.") == 0);
  CHECK(e.ask("get robot model") == "UR5");
  CHECK(e.ask("get serial number").substr(0, 2) == "20");
  CHECK(e.ask("is in remote control") == "true");
  CHECK(cb3.ask("is in remote control").find("could not understand") == 0);
  CHECK(e.ask("popup hello") == "showing popup");
  CHECK(e.controller->popup());
  CHECK(e.ask("close popup") == "closing popup");
  CHECK_FALSE(e.controller->popup());
  CHECK(e.ask("addToLog x") == "Added log message");
  CHECK(e.ask("isProgramSaved") == "true <unnamed>");
  CHECK(e.ask("load installation default.installation") == "Loading installation: default.installation");
  CHECK(e.ask("make coffee") == "could not understand: 'make coffee'");
  CHECK(e.open);
  CHECK(e.ask("quit\r") == "Disconnected");
  CHECK_FALSE(e.open);
  CHECK_FALSE(e.session->shutdown());
  CHECK(cb3.ask("shutdown") == "Shutting down");
  CHECK(cb3.session->shutdown());
}

TEST_CASE("Dashboard: what the makers' client expects: roles, modes, reports, states that hold at once") {
  Bench cb3(Series::cb3), e;
  CHECK(cb3.ask("setUserRole OPERATOR") == "Setting user role: OPERATOR");
  CHECK(cb3.ask("getUserRole") == "OPERATOR");
  CHECK(cb3.ask("setUserRole RESTRICTED") == "Setting user role: RESTRICTED");
  CHECK(cb3.ask("setUserRole king") == "Failed setting user role: king");
  CHECK(cb3.ask("getUserRole") == "RESTRICTED");
  CHECK(e.ask("getUserRole").find("could not understand") == 0);
  CHECK(e.ask("get operational mode") == "NONE");
  CHECK(e.ask("set operational mode manual") == "Operational mode manual is set");
  CHECK(e.ask("get operational mode") == "MANUAL");
  CHECK(e.ask("set operational mode fast") == "Failed to execute: set operational mode fast");
  CHECK(e.ask("clear operational mode").find("No longer controlling the operational mode. ") == 0);
  CHECK(e.ask("get operational mode") == "NONE");
  CHECK(e.ask("generate flight report controller").find("Flight Report generated with id:") == 0);
  CHECK(e.ask("generate flight report").find("Flight Report generated with id:") == 0);
  CHECK(e.ask("generate support file .").find("Completed successfully:") == 0);
  CHECK(e.ask("saveLog") == "Log saved to disk");
  CHECK(e.ask("popup") == "showing popup");
  // A program by its path; the state names the file. Every answer holds in the cycle of its question.
  CHECK(e.ask("load /programs/deep/stream.urp") == "Loading program: /programs/deep/stream.urp");
  CHECK(e.ask("programState") == "STOPPED stream.urp");
  CHECK(e.ask("isProgramSaved") == "true stream.urp");
  e.ask("brake release");
  e.run(3);
  CHECK(e.ask("play") == "Starting program");
  CHECK(e.ask("programState") == "PLAYING stream.urp");
  CHECK(e.ask("running") == "Program running: true");
  CHECK(e.ask("stop") == "Stopped");
  CHECK(e.ask("programState") == "STOPPED stream.urp");
  CHECK(e.ask("running") == "Program running: false");
  CHECK(e.ask("loads of nothing").find("could not understand") == 0);
}

TEST_CASE("Dashboard: random lines are answered line by line or end the session") {
  Random random(41);
  const std::string_view words[] = {"power",
                                    " ",
                                    "on",
                                    "off",
                                    "play",
                                    "load",
                                    "stop",
                                    "robotmode",
                                    "popup",
                                    "\n",
                                    "\r",
                                    "brake release",
                                    "unlock protective stop",
                                    "\x01",
                                    "\xff",
                                    "%s"};
  for (int n = 0; n < 500; ++n) {
    Bench b;
    bool open = true;
    for (int i = 0; i < 20 && open; ++i) {
      std::string text;
      const int length = static_cast<int>(random.uniform() * 40);
      for (int k = 0; k < length; ++k) text += words[random.bits() % std::size(words)];
      std::string out;
      open = b.session->receive(raw::bytes(text), out);
      for (const char c : out) CHECK((c == '\n' || (c >= ' ' && c <= '~')));
      b.controller->step();
    }
  }
  Bench b;
  std::string out;
  CHECK_FALSE(b.session->receive(raw::Bytes(5000, 'x'), out));
  CHECK(out.find("could not understand") == 0);
}
