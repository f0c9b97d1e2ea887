// SPDX-License-Identifier: BSD-3-Clause
// The lines of a robot's joints and the poses of its cells, from a motion that all of them feel.
#pragma once

#include <algorithm>
#include <optional>

#include "skinctl/calibration/detail/line_report.hpp"
#include "skinctl/calibration/detail/line_start.hpp"
#include "skinctl/calibration/joint_lines_types.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Fits the lines of all joints, the poses and sensor errors of all cells, and one lateness of the cells'
/// stamps to the block means of a recording; it needs no start.
///
/// The recording has to begin at home, with the motion or before it, and each joint has to move alone from
/// there for a second or more; then all may move. What cannot be known is named in `unobservable`; a cell
/// whose pose is worse known than the limits has `known == false` and a reason. Joints must be revolute and
/// form one chain, in the order of the columns of `joints.q`.
///
/// Throws `ConfigurationError` for recordings that are too short or damaged, see `MeasuredMotion`, and if no
/// joint moves any cell.
[[nodiscard]] inline JointLines find_joint_lines(const MotionRecording& recording,
                                                 const JointLinesSettings& s = {}) {
  const MeasuredMotion motion(recording.joints);
  require(!recording.cells.empty(), "cells", 0, ">= 1");
  require(recording.places.empty() || recording.places.size() == recording.cells.size(), "places of cells",
          double(recording.places.size()), "one per cell, or none");
  require(s.block >= 0.005 && s.block <= 0.1, "length of a block", s.block, "0.005 to 0.1 s");
  require(s.bias > 0 && s.scale > 0 && s.cross_axis > 0, "bias, scale and cross-axis sensitivity",
          std::min({s.bias, s.scale, s.cross_axis}), "> 0");
  const double slack = 0.2;  // for the lateness
  auto data =
      detail::fit::block_means(recording.cells, motion.start() + slack, motion.end() - slack, s.block);
  for (Eigen::Index k = 0; k < data.blocks(); ++k)
    if (motion.gap_within(data.middle(k) - slack, data.middle(k) + slack)) {
      data.missing.row(k).setConstant(true);
      data.y.row(k).setZero();
    }

  JointLines out;
  ActivationSettings activation = s.activation;
  activation.gravity = s.gravity;
  out.activation = find_activation(data, motion, activation);
  out.home = out.activation.home;
  detail::fit::refuse_hidden_motion(motion, out.activation);
  detail::fit::LineStart start = detail::fit::start_lines(out.activation, recording.places, data);
  out.joints = start.joints;
  require(!start.joints.empty() && !start.cells.empty(), "joints that move a cell, alone and from home", 0,
          ">= 1");

  std::optional<MeasuredMotion> torque;
  if (recording.torque.size() > 0) {
    require(recording.torque.rows() == recording.joints.q.rows() &&
                recording.torque.cols() == recording.joints.q.cols(),
            "rows of torques", double(recording.torque.rows()), "one per stamp, a column per joint");
    torque.emplace(JointRecording{recording.joints.time, recording.torque}, 0.1);
  }
  detail::fit::CellFitSettings fit_settings;
  fit_settings.bias = s.bias, fit_settings.scale = s.scale, fit_settings.cross_axis = s.cross_axis;
  fit_settings.steps = s.steps;
  fit_settings.tie_position = s.tie_position, fit_settings.tie_turn = s.tie_turn;
  detail::fit::BlockMeans used = detail::fit::only_cells(data, start.used);
  detail::fit::CellFit<detail::fit::LineMotion> fit(
      used,
      detail::fit::LineMotion(motion, start.joints, out.home, start.lines, out.activation.lateness, s.gravity,
                              torque ? &*torque : nullptr),
      start.cells, start.patches, fit_settings);
  fit.run();
  fit.weigh();
  detail::fit::leave_out_liars(fit, used, start);
  fit.run();
  fit.weigh();
  detail::fit::report_lines(fit, start, s, torque.has_value(), out);
  return out;
}

SKINCTL_END_NAMESPACE
