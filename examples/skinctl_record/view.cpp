#include "examples/skinctl_record/view.hpp"

#include <chrono>
#include <cstdio>
#include <thread>

#include "examples/adapters/live/foxglove_server.hpp"
#include "examples/live_page/page.hpp"
#include "examples/support/job.hpp"
#include "skinctl/recording/mcap_file.hpp"

namespace skinctl_record {

int view(const std::string& path, std::uint16_t port) {
  const skinctl::MappedFile file(path);
  adapters::live::ServerOptions options;
  options.port = port;
  live_page::put_page(options);
  options.files["/recording.mcap"] = {
      "application/octet-stream",
      std::string(reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size())};
  adapters::live::FoxgloveServer server(std::move(options));
  const examples::job::StopSignals signals;
  server.start();
  std::printf("%s: %s?file=recording.mcap, until Ctrl-C\n", path.c_str(), server.url().c_str());
  std::fflush(stdout);
  while (!signals.asked()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  return 0;
}

}  // namespace skinctl_record
