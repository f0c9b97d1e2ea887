// Recorded runs: what is in a file, an end for one that was cut, a topic as a table. See README.md beside
// this file.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>

#include "examples/skinctl_record/csv.hpp"
#include "examples/skinctl_record/view.hpp"
#include "examples/support/output_file.hpp"
#include "examples/support/program.hpp"
#include "skinctl/recording/mcap_file.hpp"

namespace {

using namespace skinctl;

int info(const std::string& path) {
  const MappedFile file(path);
  const auto found = read_mcap(file.bytes(), [](const McapMessage&) {});
  if (!found.is_mcap) refuse(path + ": no MCAP file");
  const auto [first, last] = found.summary.times();
  std::printf("%s: profile %s, written by %s\n", path.c_str(), found.profile.c_str(), found.library.c_str());
  std::printf("%llu messages in %zu chunks, %.3f s%s\n",
              static_cast<unsigned long long>(found.summary.messages()), found.summary.chunks.size(),
              1e-9 * static_cast<double>(last - first),
              found.whole ? "" : "; the file was cut: `skinctl_record recover` ends it");
  const std::string missing = found.left_out();
  if (!missing.empty()) std::printf("%s\n", missing.c_str());
  for (const auto& [name, facts] : found.metadata) {
    std::printf("%s\n", name.c_str());
    for (const auto& [key, value] : facts) std::printf("  %s: %s\n", key.c_str(), value.c_str());
  }
  std::printf("%10s  %-28s %s\n", "messages", "topic", "type");
  for (const auto& c : found.summary.channels) {
    const auto count = found.summary.counts.find(c.id);
    const auto* schema = found.schema(c.schema);
    std::printf("%10llu  %-28s %s\n",
                static_cast<unsigned long long>(count != found.summary.counts.end() ? count->second : 0),
                c.topic.c_str(), schema != nullptr ? schema->name.c_str() : c.encoding.c_str());
  }
  return found.whole && missing.empty() ? 0 : 1;
}

int run(int argc, char** argv) {
  CLI::App app{"Recorded runs (MCAP): what is in them, an end for one that was cut, topics as tables."};
  app.require_subcommand(1);
  std::string file, topic, output;
  auto* info_command =
      app.add_subcommand("info", "Says what a file holds; exit code 1 if not all of it is read");
  auto* recover_command = app.add_subcommand("recover", "Gives a file that was cut an end, in place");
  auto* csv_command = app.add_subcommand("csv", "Writes the messages of a topic as a table");
  auto* view_command = app.add_subcommand("view", "Serves the live page with the recording, on 127.0.0.1");
  std::uint16_t port = 0;
  view_command->add_option("--port", port, "TCP port; 0: any");
  for (auto* command : {info_command, recover_command, csv_command, view_command})
    command->add_option("file", file, "MCAP file")->required();
  csv_command->add_option("topic", topic, "such as /joint_states")->required();
  csv_command->add_option("--output", output, "file; without it the standard output");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  if (*info_command) return info(file);
  if (*view_command) return skinctl_record::view(file, port);
  if (*recover_command) {
    const auto done = recover(file);
    std::printf(
        "%s: %llu messages, %s\n", file.c_str(), static_cast<unsigned long long>(done.messages),
        done.was_whole
            ? "whole, not touched"
            : ("ended behind its last whole record, " + std::to_string(done.cut) + " bytes cut").c_str());
    if (!done.left_out.empty()) std::fprintf(stderr, "%s: %s\n", file.c_str(), done.left_out.c_str());
    return done.left_out.empty() ? 0 : 1;
  }
  examples::refuse_own_input(output, {file});
  const MappedFile mapped(file);
  skinctl_record::Table written;
  if (output.empty()) {
    written = skinctl_record::write_csv(mapped.bytes(), topic, std::cout);
    if (!std::cout.flush()) return 2;
  } else {
    std::ofstream table(output);
    written = skinctl_record::write_csv(mapped.bytes(), topic, table);
    table.flush();
    if (!table) refuse(output + ": cannot be written");
    std::printf("%s: %zu lines\n", output.c_str(), written.lines);
  }
  if (!written.left_out.empty()) std::fprintf(stderr, "%s: %s\n", file.c_str(), written.left_out.c_str());
  return written.left_out.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
