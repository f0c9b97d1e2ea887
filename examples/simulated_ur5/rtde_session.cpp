#include "examples/simulated_ur5/rtde_session.hpp"

#include <algorithm>
#include <cmath>

#include "examples/simulated_ur5/version.hpp"

namespace simulated_ur5::rtde {
namespace {

constexpr std::size_t most_input_recipes = 255;

void reply_byte(std::vector<std::uint8_t>& out, Package type, std::uint8_t value) {
  PackageWriter w(out, type);
  w.u8(value);
  w.finish();
}

std::string_view as_text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string printable(std::string_view text) {
  std::string out(text.substr(0, 80));
  for (char& c : out)
    if (c < ' ' || c > '~') c = '?';
  return out;
}

}  // namespace

Session::Session(Controller& controller, InputOwners& owners, const Quirks& quirks, std::uint64_t seed)
    : controller_(controller), owners_(owners), quirks_(quirks), random_(seed) {}

void Session::complain(std::vector<std::uint8_t>& out, Level level, const std::string& text) const {
  write_text(out, version_, level, text, "RTDE");
  if (controller_.on_message) controller_.on_message("RTDE: " + text);
}

bool Session::receive(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& out) {
  for (;;) {
    while (const auto frame = framer_.next())
      if (!handle(*frame, out)) return false;
    if (framer_.broken()) {
      complain(out, Level::exception, "package size outside 3 to " + std::to_string(largest_request));
      return false;
    }
    if (bytes.empty()) return true;
    const std::size_t n = std::min(bytes.size(), framer_.room());
    framer_.feed(bytes.first(n));
    bytes = bytes.subspan(n);
  }
}

bool Session::handle(const Framer::Frame& frame, std::vector<std::uint8_t>& out) {
  BigEndianReader in(frame.payload);
  const auto wrong_size = [&](std::size_t expected) {
    if (frame.payload.size() == expected) return false;
    complain(out, Level::exception,
             std::string("package '") + static_cast<char>(frame.type) + "' with " +
                 std::to_string(frame.payload.size()) + " bytes of payload, expected " +
                 std::to_string(expected));
    return true;
  };
  switch (static_cast<Package>(frame.type)) {
    case Package::request_protocol_version: {
      if (wrong_size(2)) return false;
      const std::uint16_t wanted = in.u16();
      const bool accepted = wanted == 1 || wanted == 2;
      if (accepted) version_ = wanted;
      reply_byte(out, Package::request_protocol_version, accepted ? 1 : 0);
      return true;
    }
    case Package::get_urcontrol_version: {
      if (wrong_size(0)) return false;
      const Version v = controller_.version();
      PackageWriter w(out, Package::get_urcontrol_version);
      for (const std::uint32_t part : {v.major, v.minor, v.bugfix, v.build}) w.u32(part);
      w.finish();
      return true;
    }
    case Package::setup_outputs:
      setup_outputs(in, out);
      return true;
    case Package::setup_inputs:
      setup_inputs(in, out);
      return true;
    case Package::start: {
      if (wrong_size(0)) return false;
      const bool accepted = !outputs_.empty();
      if (!accepted) complain(out, Level::error, "start without a valid output recipe");
      if (accepted && !started_) {
        started_ = true;
        until_next_ = 0;
        if (quirks_.data_before_start_reply) write_data(out);
      }
      reply_byte(out, Package::start, accepted ? 1 : 0);
      return true;
    }
    case Package::pause:
      if (wrong_size(0)) return false;
      started_ = false;
      reply_byte(out, Package::pause, 1);
      return true;
    case Package::data:
      take_data(in, out);
      return true;
    case Package::text_message:
      if (controller_.on_message)
        controller_.on_message("RTDE client says: " + printable(as_text(in.rest())));
      return true;
  }
  complain(out, Level::exception, "unknown package type " + std::to_string(frame.type));
  return false;
}

void Session::setup_outputs(BigEndianReader& in, std::vector<std::uint8_t>& out) {
  const double rate = 1 / seconds(controller_.cycle());
  const double frequency = version_ >= 2 ? in.f64() : rate;
  const auto bytes = in.rest();
  bool valid = in.ok();
  if (valid && started_) {
    complain(out, Level::error, "output recipe while data flows: pause first");
    valid = false;
  }
  if (valid && !(frequency > 0)) {
    complain(out, Level::error, "output frequency must be above 0");
    valid = false;
  }
  if (valid && bytes.size() > longest_name_list) {
    complain(out, Level::error, "list of names longer than 2048 bytes");
    valid = false;
  }
  std::vector<Output> recipe;
  std::string types;
  if (valid) {
    for (const std::string_view name : split_names(as_text(bytes))) {
      const auto output = find_output(name);
      if (!types.empty()) types += ',';
      if (output) {
        types += type_name(output->type);
        recipe.push_back(*output);
      } else {
        types += "NOT_FOUND";
        valid = false;
      }
    }
  }
  if (!started_) {
    outputs_ = valid ? std::move(recipe) : std::vector<Output>{};
    divider_ = valid ? static_cast<int>(std::clamp(std::floor(rate / frequency + 1e-9), 1.0, 1e6)) : 1;
  }
  PackageWriter w(out, Package::setup_outputs);
  if (version_ >= 2) w.u8(valid && !outputs_.empty() ? 1 : 0);
  w.text(types);
  w.finish();
}

void Session::setup_inputs(BigEndianReader& in, std::vector<std::uint8_t>& out) {
  const auto bytes = in.rest();
  InputRecipe recipe;
  std::string types;
  bool valid = true;
  if (bytes.size() > longest_name_list) {
    complain(out, Level::error, "list of names longer than 2048 bytes");
    valid = false;
  } else if (inputs_.size() >= most_input_recipes) {
    complain(out, Level::error, "more than 255 input recipes");
    valid = false;
  } else {
    for (const std::string_view name : split_names(as_text(bytes))) {
      const auto input = find_input(name);
      if (!types.empty()) types += ',';
      if (!input) {
        types += "NOT_FOUND";
        valid = false;
        continue;
      }
      const bool twice = std::any_of(recipe.inputs.begin(), recipe.inputs.end(),
                                     [&](const Input& i) { return i.key == input->key; });
      if (twice || !owners_.free_for(input->key, this)) {
        types += "IN_USE";
        valid = false;
        continue;
      }
      types += type_name(input->type);
      recipe.inputs.push_back(*input);
      recipe.size += type_size(input->type);
      recipe.names.emplace_back(name);
      recipe.effects.slider = recipe.effects.slider || name.starts_with("speed_slider");
      recipe.effects.standard = recipe.effects.standard || name.starts_with("standard_digital");
      recipe.effects.configurable = recipe.effects.configurable || name.starts_with("configurable_digital");
      recipe.effects.tool = recipe.effects.tool || name.starts_with("tool_digital");
    }
    if (recipe.inputs.empty()) valid = false;
  }
  std::uint8_t id = 0;
  if (valid) {
    for (const Input& i : recipe.inputs) owners_.take(i.key, this);
    inputs_.push_back(std::move(recipe));
    id = static_cast<std::uint8_t>(inputs_.size());
  }
  PackageWriter w(out, Package::setup_inputs);
  w.u8(id);
  w.text(types);
  w.finish();
}

void Session::take_data(BigEndianReader& in, std::vector<std::uint8_t>& out) {
  const std::uint8_t id = in.u8();
  if (!in.ok() || id == 0 || id > inputs_.size()) {
    complain(out, Level::error, "data for input recipe " + std::to_string(id) + ", which was not set up");
    return;
  }
  const InputRecipe& recipe = inputs_[id - 1u];
  if (in.left() != recipe.size) {
    complain(out, Level::error,
             "data of " + std::to_string(in.left()) + " bytes for input recipe " + std::to_string(id) +
                 ", expected " + std::to_string(recipe.size));
    return;
  }
  for (const Input& i : recipe.inputs) i.read(controller_.inputs(), i.index, in);
  controller_.inputs_written(recipe.effects);
  const std::string& watched = controller_.watched_input();
  if (!watched.empty() && std::find(recipe.names.begin(), recipe.names.end(), watched) != recipe.names.end())
    controller_.watchdog_fed();
}

void Session::write_data(std::vector<std::uint8_t>& out) const {
  PackageWriter w(out, Package::data);
  if (version_ >= 2) w.u8(1);
  for (const Output& o : outputs_) o.write(controller_.state(), o.index, w);
  w.finish();
}

bool Session::publish(std::vector<std::uint8_t>& out, bool late) {
  if (!started_) return false;
  if (until_next_ > 0) {
    --until_next_;
    return false;
  }
  until_next_ = divider_ - 1;
  if (late || (quirks_.skipped_outputs > 0 && random_.uniform() < quirks_.skipped_outputs)) return false;
  write_data(out);
  return true;
}

}  // namespace simulated_ur5::rtde
