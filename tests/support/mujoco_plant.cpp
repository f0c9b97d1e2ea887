#include "tests/support/mujoco_plant.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include "tests/support/mujoco_oracle.hpp"

namespace oracle {

struct MujocoPlant::State {
  mjModel* model = nullptr;
  mjData* data = nullptr;
  std::vector<double> target, stiffness, damping, q, dq, motor, contact;
  std::vector<int> body;

  State(const Robot& robot, const std::vector<double>& start, const ServoSettings& s) {
    const std::string xml = mjcf(robot);
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    char error[500] = "";
    if (mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(xml.size())) != 0)
      throw std::runtime_error("MuJoCo: no room for the model");
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    model = mj_loadXML("robot.xml", files.get(), error, sizeof error);
    mj_deleteVFS(files.get());
    if (model == nullptr) throw std::runtime_error(error);
    data = mj_makeData(model);
    model->opt.timestep = s.step;
    const auto n = static_cast<std::size_t>(model->nv);
    for (int i = 0; i < robot.body_count(); ++i)
      body.push_back(mj_name2id(model, mjOBJ_BODY, ("b" + std::to_string(i)).c_str()));
    for (std::size_t i = 0; i < n; ++i) {
      model->dof_armature[i] = s.rotor.empty() ? 1 : s.rotor[i];
      data->qpos[i] = start[i];
    }
    mj_forward(model, data);
    std::vector<double> mass(n * n);
    mj_fullM(model, mass.data(), data->qM);
    for (std::size_t i = 0; i < n; ++i) {
      stiffness.push_back(mass[i * n + i] * s.bandwidth * s.bandwidth);
      damping.push_back(2 * mass[i * n + i] * s.bandwidth);
    }
    mj_step1(model, data);
    target = q = start;
    dq.assign(n, 0);
    motor = contact = dq;
  }
  ~State() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
};

MujocoPlant::MujocoPlant(const Robot& robot, const std::vector<double>& q, const ServoSettings& settings)
    : state_(std::make_unique<State>(robot, q, settings)) {}
MujocoPlant::~MujocoPlant() = default;
MujocoPlant::MujocoPlant(MujocoPlant&&) noexcept = default;

void MujocoPlant::command(const double* q) {
  std::copy_n(q, state_->target.size(), state_->target.begin());
}

void MujocoPlant::step(int body, const double* point, const double* force) {
  State& s = *state_;
  const int b = s.body[static_cast<std::size_t>(body)];
  double at[3];
  mju_rotVecMat(at, point, s.data->xmat + 9 * b);
  mju_addTo3(at, s.data->xpos + 3 * b);
  const double none[3] = {};
  for (std::size_t i = 0; i < s.q.size(); ++i)
    s.motor[i] = s.data->qfrc_bias[i] + s.stiffness[i] * (s.target[i] - s.data->qpos[i]) -
                 s.damping[i] * s.data->qvel[i];
  std::fill(s.contact.begin(), s.contact.end(), 0.0);
  mj_applyFT(s.model, s.data, force, none, at, b, s.contact.data());
  for (std::size_t i = 0; i < s.q.size(); ++i) s.data->qfrc_applied[i] = s.motor[i] + s.contact[i];
  mj_step2(s.model, s.data);
  mj_step1(s.model, s.data);
  std::copy_n(s.data->qpos, s.q.size(), s.q.begin());
  std::copy_n(s.data->qvel, s.dq.size(), s.dq.begin());
}

double MujocoPlant::time() const {
  return state_->data->time;
}
const std::vector<double>& MujocoPlant::q() const {
  return state_->q;
}
const std::vector<double>& MujocoPlant::dq() const {
  return state_->dq;
}
const std::vector<double>& MujocoPlant::motor_torque() const {
  return state_->motor;
}
const std::vector<double>& MujocoPlant::contact_torque() const {
  return state_->contact;
}

void MujocoPlant::point(int body, const double* at, double* place, double* velocity, double* axes) {
  State& s = *state_;
  const int b = s.body[static_cast<std::size_t>(body)];
  mju_rotVecMat(place, at, s.data->xmat + 9 * b);
  mju_addTo3(place, s.data->xpos + 3 * b);
  std::copy_n(s.data->xmat + 9 * b, 9, axes);
  std::vector<double> J(3 * s.q.size());
  mj_jac(s.model, s.data, J.data(), nullptr, place, b);
  for (std::size_t r = 0; r < 3; ++r) {
    velocity[r] = 0;
    for (std::size_t i = 0; i < s.q.size(); ++i) velocity[r] += J[r * s.q.size() + i] * s.dq[i];
  }
}

}  // namespace oracle
