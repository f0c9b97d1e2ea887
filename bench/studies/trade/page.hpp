// The rows of the trade study: as CSV, as a page with both questions, as tables and pictures.
#pragma once

#include <string>
#include <vector>

#include "bench/studies/bounds/brackets.hpp"
#include "bench/studies/trade/point.hpp"

namespace trade {

/// Of a row: a cycle's time [us], hot or cold.
enum class Clock { hot, cold };
[[nodiscard]] double cost(const Row& row, Clock clock);
/// The larger of the errors of both worlds [mm].
[[nodiscard]] double error(const Row& row);

/// Sets each row's verdict. A choice is real if it moves its scene's Pareto front by 5 %: whoever needs its
/// accuracy (to 10 %) pays that much more without it, in instructions (in time where they were not counted),
/// or in bytes.
void judge(std::vector<Row>& rows);
/// Whether a row may answer a question: a preset, or a real choice.
[[nodiscard]] bool offered(const Row& row);

/// "I have `us`": the most accurate offered row of the scene that costs at most that; null: there is none.
[[nodiscard]] const Row* within_time(const std::vector<Row>& rows, const std::string& scene, Clock clock,
                                     double us);
/// "I need `mm` and `N`": the cheapest offered row of the scene that is off by at most that; null: there is
/// none.
[[nodiscard]] const Row* within_error(const std::vector<Row>& rows, const std::string& scene, Clock clock,
                                      double mm, double N);

/// Throw `std::runtime_error` with file and line where a file cannot be read or written.
void write_csv(const std::vector<Row>& rows, const std::string& file);
[[nodiscard]] std::vector<Row> read_csv(const std::string& file);
/// With what is proven of the rounding alone: shown as a table, and beside the answers of scenes with these
/// robots.
void write_page(const std::vector<Row>& rows, const std::vector<skinctl::bounds::Bracket>& proven,
                const std::string& file);
[[nodiscard]] std::string page(const std::vector<Row>& rows,
                               const std::vector<skinctl::bounds::Bracket>& proven);
[[nodiscard]] std::string as_markdown(const std::vector<Row>& rows);
/// The table of what is proven of a robot's rounding; of all other robots the ratios, worst first.
[[nodiscard]] std::string as_markdown(const std::vector<skinctl::bounds::Bracket>& proven);
/// Cost against error of one scene, for a README; all of them as `cost_and_error_K.svg` in a folder that is
/// there.
[[nodiscard]] std::string picture(const std::vector<Row>& rows, const std::string& scene);
void write_pictures(const std::vector<Row>& rows, const std::string& folder);

}  // namespace trade
