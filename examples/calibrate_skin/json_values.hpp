// Vectors, poses, covariances and tables of a calibration's files.
#pragma once

#include <vector>

#include "examples/calibrate_skin/steps.hpp"
#include "skinctl/calibration/estimate.hpp"
#include "skinctl/calibration/pose_uncertainty.hpp"

namespace calibrate_skin {

[[nodiscard]] Json json_of(const Eigen::Vector3d& v);
/// The upper triangle by rows, as in a skin file.
[[nodiscard]] Json json_of(const skinctl::Matrix6d& C);
[[nodiscard]] Json json_of(const std::vector<skinctl::Unobservable>& all);
[[nodiscard]] Json rows_of(const Eigen::MatrixXd& m);

/// JSON has no NaN: null. Throws what the JSON library throws where a value is another one, as all of these.
[[nodiscard]] double number(const Json& v);
[[nodiscard]] Eigen::Vector3d vector_of(const Json& v);
[[nodiscard]] skinctl::Matrix6d matrix_of(const Json& C);
/// Of as many columns as the first row has.
[[nodiscard]] Eigen::MatrixXd matrix_of_rows(const Json& rows);
/// Appends the elements of `more`.
void add(Json& to, const Json& more);

}  // namespace calibrate_skin
