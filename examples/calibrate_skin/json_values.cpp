#include "examples/calibrate_skin/json_values.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>

namespace calibrate_skin {

using namespace skinctl;

Json json_of(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
Json json_of(const Matrix6d& C) {
  Json out = Json::array();
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) out.push_back(C(i, j));
  return out;
}
Json json_of(const std::vector<Unobservable>& all) {
  Json out = Json::array();
  for (const auto& u : all)
    out.push_back({{"what", u.name},
                   {"deviation", std::isfinite(u.deviation) ? Json(u.deviation) : Json()},
                   {"unit", u.unit},
                   {"remedy", u.remedy}});
  return out;
}
Json rows_of(const Eigen::MatrixXd& m) {
  Json out = Json::array();
  for (Eigen::Index k = 0; k < m.rows(); ++k) {
    Json row = Json::array();
    for (Eigen::Index i = 0; i < m.cols(); ++i) row.push_back(m(k, i));
    out.push_back(std::move(row));
  }
  return out;
}

double number(const Json& v) {
  return v.is_null() ? std::nan("") : v.get<double>();
}
Eigen::Vector3d vector_of(const Json& v) {
  return {number(v.at(0)), number(v.at(1)), number(v.at(2))};
}
Matrix6d matrix_of(const Json& C) {
  Matrix6d out;
  std::size_t k = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) out(i, j) = out(j, i) = C.at(k++).get<double>();
  return out;
}
void add(Json& to, const Json& more) {
  for (const auto& x : more) to.push_back(x);
}
Eigen::MatrixXd matrix_of_rows(const Json& rows) {
  const std::size_t columns = rows.empty() ? 0 : rows.at(0).size();
  Eigen::MatrixXd out(Eigen::Index(rows.size()), Eigen::Index(columns));
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (std::size_t i = 0; i < columns; ++i)
      out(Eigen::Index(k), Eigen::Index(i)) = number(rows.at(k).at(i));
  return out;
}

Json json_of(const FitPose& X) {
  const Eigen::Quaterniond q(X.R);
  return {{"p", {X.p.x(), X.p.y(), X.p.z()}}, {"q", {q.x(), q.y(), q.z(), q.w()}}};
}
FitPose pose_of(const Json& X) {
  const Json& q = X.at("q");
  return {Eigen::Quaterniond(number(q.at(3)), number(q.at(0)), number(q.at(1)), number(q.at(2)))
              .normalized()
              .toRotationMatrix(),
          vector_of(X.at("p"))};
}

Json read_json(const fs::path& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path.string() + ": is not there");
  Json value = Json::parse(in, nullptr, false);
  if (value.is_discarded())
    throw std::runtime_error(path.string() + ": no JSON; remove it, and its step runs again");
  return value;
}
void write_text(const fs::path& path, const std::string& text) {
  const fs::path part = path.string() + ".part";
  {
    std::ofstream out(part, std::ios::binary);
    out << text << std::flush;
    if (!out) throw std::runtime_error(part.string() + ": cannot be written");
  }
  fs::rename(part, path);
}
void write_json(const fs::path& path, const Json& value) {
  write_text(path, value.dump());
}

}  // namespace calibrate_skin
