// Promise: a skin that is sent as a point cloud is the same skin: every sample once, to the bit
// Tried: 200 frames of 300 cells, clocks at both ends of time, every changed byte of the description

#include <doctest/doctest.h>

#include <random>

#include "skinctl/io/skin_cloud_reader.hpp"
#include "skinctl/testing/allocation_guard.hpp"

using namespace skinctl;

namespace {

std::vector<SkinCloud::Cell> cells(std::uint32_t n) {
  std::vector<SkinCloud::Cell> out;
  for (std::uint32_t i = 0; i < n; ++i)
    out.push_back({1000003 * i + 7, i * 6 / n, {0.01f * float(i), 0.02f, -0.03f * float(i)}});
  return out;
}
CellSample sample(std::uint32_t cell, Nanoseconds time) {
  return {time, cell, {0.125f, 0.25f, 0.5f}, 0.75f, {1, 2, 3}, 36.5f};
}

/// The points of a message, found by its fields as a reader that knows nothing of `SkinPoint` finds them.
struct Points {
  std::vector<std::pair<std::string, std::uint32_t>> fields;
  std::span<const unsigned char> data;
  template <class V>
  V at(std::size_t i, const std::string& name) const {
    for (const auto& [field, offset] : fields)
      if (field == name) {
        V v;
        std::memcpy(&v, data.data() + 64 * i + offset, sizeof v);
        return v;
      }
    FAIL("no field ", name);
    return {};
  }
};
Points taken_apart(std::span<const unsigned char> message, Nanoseconds stamp) {
  Points out;
  CdrReader r(message);
  CHECK(r.get<std::int32_t>() == stamp / 1s);
  CHECK(r.get<std::uint32_t>() == (stamp % 1s).count());
  CHECK(r.text() == "base_link");
  CHECK(r.get<std::uint32_t>() == 1);
  const auto n = r.get<std::uint32_t>();
  for (std::size_t k = r.count(13); k > 0; --k) {
    const std::string name(r.text());
    out.fields.emplace_back(name, r.get<std::uint32_t>());
    static_cast<void>(r.get<std::uint8_t>());
    CHECK(r.get<std::uint32_t>() == 1);
  }
  CHECK_FALSE(r.get<bool>());
  CHECK(r.get<std::uint32_t>() == 64);
  CHECK(r.get<std::uint32_t>() == 64 * n);
  REQUIRE(r.count(1) == 64 * n);
  out.data = r.take(64 * n);
  CHECK(r.get<bool>());
  CHECK(r.fits());
  CHECK(r.left() == 0);
  return out;
}

}  // namespace

TEST_CASE("SkinCloud: 260 and 1260 cells take 17 089 and 81 089 bytes") {
  for (const auto& [n, size] : {std::pair(260u, 17'089u), {1260u, 81'089u}}) {
    SkinCloud cloud(cells(n));
    CHECK(cloud.encode(0ns).size() == size);
  }
}

TEST_CASE("SkinCloud: every field of a point, before and after its sample, and nothing is allocated") {
  SkinCloud cloud(cells(60), {.newtons = 10});
  auto before = taken_apart(cloud.encode(5s), 5s);
  CHECK(before.at<std::uint32_t>(3, "status") == SkinPoint::stale);
  CHECK(before.at<std::uint32_t>(3, "cell") == 3 * 1000003 + 7);
  CHECK(before.at<std::int32_t>(3, "age") == std::numeric_limits<std::int32_t>::max());
  CHECK(before.at<float>(3, "x") == 0.03f);

  const testing::AllocationGuard guard;
  const auto allocated = guard.count();
  CHECK(cloud.set(sample(3 * 1000003 + 7, 5s - 3ms)));
  CHECK(cloud.set(sample(30 * 1000003 + 7, 5s - 200ms)));
  CHECK_FALSE(cloud.set(sample(8, 5s)));
  CHECK(cloud.mask(7, true));
  CHECK_FALSE(cloud.mask(8, true));
  cloud.place(3, Rotation<double>{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}, {1, 2, 3});
  cloud.place(99, {}, {0, 0, 0});
  const auto message = cloud.encode(5s + 1ms);
  CHECK(guard.count() == allocated);
  const auto p = taken_apart(message, 5s + 1ms);
  CHECK(p.at<std::uint32_t>(3, "status") == 0);
  CHECK(p.at<float>(3, "force") == 8.75f);
  CHECK(p.at<float>(3, "proximity") == 0.75f);
  CHECK(p.at<float>(3, "temperature") == 36.5f);
  CHECK(p.at<float>(3, "force1") == 0.125f);
  CHECK(p.at<float>(3, "force2") == 0.25f);
  CHECK(p.at<float>(3, "force3") == 0.5f);
  CHECK(p.at<float>(3, "ax") == 1);
  CHECK(p.at<float>(3, "ay") == 2);
  CHECK(p.at<float>(3, "az") == 3);
  CHECK(p.at<std::int32_t>(3, "age") == 4'000'000);
  CHECK(p.at<std::uint32_t>(30, "status") == SkinPoint::stale);
  CHECK(p.at<std::int32_t>(30, "age") == 201'000'000);
  CHECK(p.at<float>(30, "x") == doctest::Approx(1 - 0.02));  // link 3 has the cells 30 to 39
  CHECK(p.at<float>(30, "y") == doctest::Approx(2 + 0.3));
  CHECK(p.at<float>(30, "z") == doctest::Approx(3 - 0.9));
  CHECK(p.at<float>(29, "x") == 0.29f);
  CHECK(p.at<std::uint32_t>(0, "status") == (SkinPoint::stale | SkinPoint::masked));
}

TEST_CASE("SkinCloud: the age is held where an int32 ends, also for clocks at both ends of time") {
  SkinCloud cloud(cells(4));
  constexpr auto most = std::numeric_limits<std::int32_t>::max();
  for (const auto& [time, now, age] :
       {std::tuple(0ns, Nanoseconds(most), most),
        {0ns, Nanoseconds(most - 1), most - 1},
        {Nanoseconds::min(), Nanoseconds::max(), most},
        {Nanoseconds::max(), Nanoseconds::min(), std::numeric_limits<std::int32_t>::min()}}) {
    CHECK(cloud.set(sample(7, time)));
    const auto message = cloud.encode(now);
    std::int32_t got = 0;
    std::memcpy(&got, message.data() + 448 + 44, 4);
    CHECK(got == age);
  }
}

TEST_CASE("SkinCloud: what cannot be is refused at construction") {
  using Cells = std::vector<SkinCloud::Cell>;
  CHECK_THROWS_AS(SkinCloud(Cells{{1, 0, {}}, {1, 0, {}}}), ConfigurationError);
  CHECK_THROWS_AS(SkinCloud(Cells{{1, 0, {}}, {2, 1, {}}, {3, 0, {}}}), ConfigurationError);
  CHECK_THROWS_AS(SkinCloud(Cells{{1, 0, {NAN, 0, 0}}}), ConfigurationError);
  CHECK_THROWS_AS(SkinCloud(Cells{{1, 1u << 20, {}}}), ConfigurationError);
  CHECK_THROWS_AS(SkinCloud(Cells{}, {.newtons = 0}), ConfigurationError);
  CHECK_THROWS_AS(SkinCloud(Cells{}, {.max_age = 0ns}), ConfigurationError);
  CHECK(SkinCloud(Cells{}).encode(1s).size() == 449);
}

TEST_CASE("SkinCloud: small ids, with holes among them, find their cells, and others none") {
  std::vector<SkinCloud::Cell> some;
  for (std::uint32_t i = 0; i < 40; ++i) some.push_back({3 * i + 5, 0, {}});
  SkinCloud cloud(some);
  for (std::uint32_t id = 0; id < 3000; ++id)
    CHECK(cloud.set(sample(id, 1s)) == (id >= 5 && id <= 122 && (id - 5) % 3 == 0));
  CHECK_FALSE(cloud.set(sample(0xffffffff, 1s)));
  const auto p = taken_apart(cloud.encode(1s), 1s);
  for (std::uint32_t i = 0; i < 40; ++i) {
    CHECK(p.at<std::uint32_t>(i, "cell") == 3 * i + 5);
    CHECK(p.at<std::uint32_t>(i, "status") == 0);
  }
}

TEST_CASE("SkinCloudReader: the samples come out as they went in, each once") {
  SkinCloud cloud(cells(300));
  SkinCloudReader reader(300);
  std::mt19937 random(5);
  const auto fraction = [&] { return float(random() % 4096) / 4096; };
  std::vector<CellSample> sent;
  for (int k = 1; k <= 200; ++k) {
    const Nanoseconds now = k * 4ms;
    sent.clear();
    for (auto i = std::uint32_t(random() % 5); i < 300; i += 1 + std::uint32_t(random() % 16))
      sent.push_back({now - Nanoseconds(random() % 3'000'000),
                      1000003 * i + 7,
                      {fraction(), fraction(), fraction()},
                      fraction(),
                      {fraction(), -fraction(), 9.81f},
                      30 + fraction(),
                      std::uint16_t(random() % 100),
                      std::uint16_t(random() % 1000)});
    for (const CellSample& s : sent) REQUIRE(cloud.set(s));
    const auto got = reader.read(cloud.encode(now));
    REQUIRE(got.size() == sent.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
      CHECK(got[i].time == sent[i].time);
      CHECK(got[i].cell == sent[i].cell);
      CHECK(got[i].force == sent[i].force);
      CHECK(got[i].proximity == sent[i].proximity);
      CHECK(got[i].acceleration == sent[i].acceleration);
      CHECK(got[i].temperature == sent[i].temperature);
      CHECK(got[i].measured == sent[i].measured);
      CHECK(got[i].unrest == sent[i].unrest);
    }
    CHECK(reader.stamp() == now);
    CHECK(reader.read(cloud.encode(now + 1ms)).empty());
  }
  CHECK(reader.refused() == 0);
}

TEST_CASE(
    "SkinCloudReader: clouds without measurements, of older senders, are read as of cells that do not say") {
  const SkinPoint point{.cell = 7, .status = 0, .measured = 0, .unrest = 0};
  const std::span bytes(reinterpret_cast<const unsigned char*>(&point), sizeof point);
  const auto fields = std::span(SkinPoint::fields).first(15);
  std::vector<unsigned char> message(1000);
  CdrWriter writer{std::span<unsigned char>(message)};
  ros::encode(writer, ros::PointCloud{1s, "base", fields, sizeof point, bytes});
  message.resize(writer.size());
  SkinCloudReader reader(1);
  const auto got = reader.read(message);
  REQUIRE(got.size() == 1);
  CHECK(got[0].cell == 7);
  CHECK(got[0].measured == unsaid);
  CHECK(got[0].unrest == unsaid);
}

TEST_CASE("SkinCloudReader: messages that are cut, changed or too large are refused, never read beyond") {
  SkinCloud cloud(cells(20));
  for (const auto& c : cells(20)) CHECK(cloud.set(sample(c.id, 1s)));
  const auto message = cloud.encode(1s);
  const std::vector<unsigned char> whole(message.begin(), message.end());
  SkinCloudReader reader(20), small(19);
  CHECK(reader.read(whole).size() == 20);
  CHECK(small.read(whole).empty());
  CHECK(small.refused() == 1);
  for (std::size_t cut = 0; cut < whole.size(); ++cut) {
    const std::vector<unsigned char> part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut));
    CHECK(SkinCloudReader(20).read(part).empty());
  }
  // A changed byte of the description: refused, or of a name's padding, which says nothing. Never a sample
  // elsewhere.
  for (std::size_t at = 26; at < 448; ++at) {
    auto changed = whole;
    changed[at] ^= 0x55;
    SkinCloudReader r(20);
    const auto got = r.read(changed);
    CHECK((got.size() == 20 || (got.empty() && r.refused() == 1)));
  }
  CHECK_THROWS_AS(SkinCloudReader(0), ConfigurationError);
}
