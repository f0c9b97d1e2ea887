// A page in headless Chromium that a test talks to: scripts evaluated, pictures taken. By the browser's own
// protocol over two pipes, so that no port is open.
#pragma once

#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "examples/support/browser.hpp"

namespace examples::browser {

/// A browser with one page. Every call fails the test (by an exception) where the browser does not answer in
/// time.
class Page {
 public:
  Page(const std::string& program, const Folder& folder, const std::vector<std::string>& more = {}) {
    std::vector<std::string> all{program,
                                 "--headless",
                                 "--no-sandbox",
                                 "--remote-debugging-pipe",
                                 "--use-gl=angle",
                                 "--use-angle=swiftshader",
                                 "--enable-unsafe-swiftshader",
                                 "--ignore-gpu-blocklist",
                                 "--disable-quic",
                                 "--no-first-run",
                                 "--disable-background-networking",
                                 "--disable-component-update",
                                 "--disable-sync",
                                 "--disable-dev-shm-usage",
                                 "--hide-scrollbars",
                                 "--user-data-dir=" + (folder.path / "page_profile").string(),
                                 "about:blank"};
    all.insert(all.end() - 1, more.begin(), more.end());
    std::vector<char*> argv;
    for (std::string& a : all) argv.push_back(a.data());
    argv.push_back(nullptr);
    int in[2], out[2];
    if (::pipe(in) != 0 || ::pipe(out) != 0) throw std::runtime_error("no pipe");
    child_ = ::fork();
    if (child_ == 0) {
      ::setpgid(0, 0);
      // The browser reads from 3 and writes to 4.
      const int from = ::fcntl(in[0], F_DUPFD, 10), to = ::fcntl(out[1], F_DUPFD, 10);
      ::dup2(from, 3);
      ::dup2(to, 4);
      const int nowhere = ::open("/dev/null", O_WRONLY);
      ::dup2(nowhere, 2);
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
    ::setpgid(child_, child_);
    ::close(in[0]);
    ::close(out[1]);
    to_ = in[1], from_ = out[0];
    const auto target = call("Target.createTarget", {{"url", "about:blank"}})["targetId"];
    session_ = call("Target.attachToTarget", {{"targetId", target}, {"flatten", true}})["sessionId"];
    call("Page.enable");
    call("Runtime.enable");
    call("Emulation.setFocusEmulationEnabled", {{"enabled", true}});  // keys arrive
  }
  ~Page() {
    ::kill(-child_, SIGKILL);
    int status = 0;
    ::waitpid(child_, &status, 0);
    ::close(to_);
    ::close(from_);
  }
  Page(const Page&) = delete;
  Page& operator=(const Page&) = delete;

  /// The window, and whether it prefers dark colours.
  void window(int width, int height, bool dark = false) {
    call("Emulation.setDeviceMetricsOverride",
         {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", width < 600}});
    call("Emulation.setEmulatedMedia",
         {{"features", {{{"name", "prefers-color-scheme"}, {"value", dark ? "dark" : "light"}}}}});
  }
  void go(const std::string& url) { call("Page.navigate", {{"url", url}}); }
  /// The value of an expression; a promise is awaited. Throws what the script throws.
  nlohmann::json evaluate(const std::string& script) {
    const auto answer = call(
        "Runtime.evaluate",
        {{"expression", script}, {"awaitPromise", true}, {"returnByValue", true}, {"userGesture", true}});
    if (answer.contains("exceptionDetails"))
      throw std::runtime_error("script: " + answer["exceptionDetails"].dump().substr(0, 600));
    return answer["result"].contains("value") ? answer["result"]["value"] : nlohmann::json();
  }
  /// Waits until an expression is true; false after `seconds`.
  bool until(const std::string& script, double seconds = 60) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    do {
      if (evaluate("(() => { try { return !!(" + script + "); } catch (e) { return false; } })()") == true)
        return true;
      ::usleep(50'000);
    } while (std::chrono::steady_clock::now() < end);
    return false;
  }
  void key(const std::string& name) {
    for (const char* type : {"keyDown", "keyUp"})
      call("Input.dispatchKeyEvent", {{"type", type}, {"key", name}, {"code", name}});
  }
  void mouse(const std::string& type, double x, double y) {
    call("Input.dispatchMouseEvent",
         {{"type", type}, {"x", x}, {"y", y}, {"button", "left"}, {"clickCount", 1}, {"buttons", 1}});
  }
  /// A finger on the screen: touchStart, touchMove, touchEnd.
  void touch(const std::string& type, double x, double y) {
    nlohmann::json points = nlohmann::json::array();
    if (type != "touchEnd") points.push_back({{"x", x}, {"y", y}});
    call("Input.dispatchTouchEvent", {{"type", type}, {"touchPoints", points}});
  }
  void picture(const fs::path& file) {
    const std::string data = call("Page.captureScreenshot", {{"format", "png"}})["data"];
    std::string bytes;
    unsigned bits = 0, held = 0;
    for (const char c : data) {
      const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
      const char* at = std::strchr(letters, c);
      if (at == nullptr || c == '\0') break;
      bits = bits << 6 | static_cast<unsigned>(at - letters);
      held += 6;
      if (held >= 8) held -= 8, bytes += static_cast<char>(bits >> held & 0xff);
    }
    std::ofstream(file, std::ios::binary) << bytes;
  }
  /// Where files go that the page saves.
  void downloads(const fs::path& folder) {
    call("Browser.setDownloadBehavior", {{"behavior", "allow"}, {"downloadPath", folder.string()}});
  }
  /// What scripts threw and wrote as errors to the console.
  [[nodiscard]] const std::string& errors() const noexcept { return errors_; }

 private:
  nlohmann::json call(const std::string& method,
                      const nlohmann::json& parameters = nlohmann::json::object()) {
    nlohmann::json message = {{"id", ++id_}, {"method", method}, {"params", parameters}};
    if (!session_.empty()) message["sessionId"] = session_;
    const std::string text = message.dump() + '\0';
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t n = ::write(to_, text.data() + done, text.size() - done);
      if (n <= 0) throw std::runtime_error("the browser is gone");
      done += static_cast<std::size_t>(n);
    }
    const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    for (;;) {
      for (std::size_t end; (end = buffer_.find('\0')) != std::string::npos;) {
        const auto answer = nlohmann::json::parse(buffer_.substr(0, end));
        buffer_.erase(0, end + 1);
        if (answer.value("id", 0) == id_) {
          if (answer.contains("error")) throw std::runtime_error(method + ": " + answer["error"].dump());
          return answer["result"];
        }
        const std::string event = answer.value("method", "");
        if (event == "Runtime.exceptionThrown" ||
            (event == "Runtime.consoleAPICalled" && answer["params"].value("type", "") == "error"))
          errors_ += answer["params"].dump().substr(0, 600) + '\n';
      }
      pollfd wait{from_, POLLIN, 0};
      if (std::chrono::steady_clock::now() > late)
        throw std::runtime_error(method + ": the browser does not answer");
      if (::poll(&wait, 1, 500) <= 0) continue;
      char part[65536];
      const ssize_t n = ::read(from_, part, sizeof part);
      if (n <= 0) throw std::runtime_error("the browser is gone");
      buffer_.append(part, static_cast<std::size_t>(n));
    }
  }

  pid_t child_ = -1;
  int to_ = -1, from_ = -1, id_ = 0;
  std::string session_, buffer_, errors_;
};

}  // namespace examples::browser
