#include "tests/support/mujoco_oracle.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace oracle {
namespace {

using Matrix = std::array<long double, 9>;

std::string digits(std::initializer_list<long double> values) {
  std::string text;
  for (const long double v : values) {
    char number[40];
    std::snprintf(number, sizeof number, "%.17g ", static_cast<double>(v));
    text += number;
  }
  text.pop_back();
  return text;
}

/// Unit quaternion of a rotation, from the largest of the four.
std::string quaternion(const Matrix& R) {
  const long double t[4] = {R[0] + R[4] + R[8], R[0] - R[4] - R[8], R[4] - R[0] - R[8], R[8] - R[0] - R[4]};
  const auto largest = std::max_element(t, t + 4) - t;
  const long double s = std::sqrt(1 + t[largest]) / 2, f = 1 / (4 * s);
  const long double x = (R[7] - R[5]) * f, y = (R[2] - R[6]) * f, z = (R[3] - R[1]) * f;
  const long double xy = (R[1] + R[3]) * f, xz = (R[2] + R[6]) * f, yz = (R[5] + R[7]) * f;
  if (largest == 0) return digits({s, x, y, z});
  if (largest == 1) return digits({x, s, xy, xz});
  if (largest == 2) return digits({y, xy, s, yz});
  return digits({z, xz, yz, s});
}

/// Jacobi rotations: A becomes diagonal, the columns of V its axes (right-handed).
void diagonalise(Matrix& A, Matrix& V) {
  V = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (int sweep = 0; sweep < 30; ++sweep)
    for (std::size_t p = 0; p < 2; ++p)
      for (std::size_t q = p + 1; q < 3; ++q) {
        if (A[3 * p + q] == 0) continue;
        const long double theta = (A[4 * q] - A[4 * p]) / (2 * A[3 * p + q]);
        const long double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const long double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (std::size_t k = 0; k < 3; ++k) {
          const long double a = A[3 * k + p], b = A[3 * k + q], v = V[3 * k + p], w = V[3 * k + q];
          A[3 * k + p] = c * a - s * b, A[3 * k + q] = s * a + c * b;
          V[3 * k + p] = c * v - s * w, V[3 * k + q] = s * v + c * w;
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const long double a = A[3 * p + k], b = A[3 * q + k];
          A[3 * p + k] = c * a - s * b, A[3 * q + k] = s * a + c * b;
        }
        A[3 * p + q] = A[3 * q + p] = 0;
      }
}

Matrix widened(const std::array<double, 9>& A) {
  Matrix B{};
  std::copy(A.begin(), A.end(), B.begin());
  return B;
}

/// Principal moments; `axes` are the rotation from the body's axes to them.
std::array<double, 3> principal(const Body& b, Matrix& axes) {
  Matrix I = widened(b.inertia);
  diagonalise(I, axes);
  return {static_cast<double>(I[0]), static_cast<double>(I[4]), static_cast<double>(I[8])};
}

void write_children(const Robot& robot, int parent, std::string& xml) {
  for (int i = 0; i < robot.body_count(); ++i) {
    const Body& b = robot.body(i);
    if (b.parent != parent) continue;
    Matrix axes;
    const auto I = principal(b, axes);
    xml += "<body name='b" + std::to_string(i) + "' pos='" + digits({b.p[0], b.p[1], b.p[2]}) + "' quat='" +
           quaternion(widened(b.R)) + "'>";
    if (b.motion != Motion::fixed)
      xml += std::string("<joint name='j") + std::to_string(i) + "' axis='0 0 1' type='" +
             (b.motion == Motion::revolute ? "hinge" : "slide") + "'/>";
    xml += "<inertial mass='" + digits({b.mass}) + "' pos='" + digits({b.com[0], b.com[1], b.com[2]}) +
           "' quat='" + quaternion(axes) + "' diaginertia='" + digits({I[0], I[1], I[2]}) + "'/>";
    write_children(robot, i, xml);
    xml += "</body>";
  }
}

struct FreeModel {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
};
struct FreeData {
  void operator()(mjData* d) const { mj_deleteData(d); }
};

}  // namespace

std::string mjcf(const Robot& robot) {
  std::string xml =
      "<mujoco><compiler angle='radian' inertiafromgeom='false' balanceinertia='true' boundmass='0' "
      "boundinertia='0'/><size njmax='0' nconmax='0'/><option gravity='" +
      digits({robot.gravity[0], robot.gravity[1], robot.gravity[2]}) +
      "'><flag contact='disable' constraint='disable' limit='disable' "
      "passive='disable' energy='enable'/></option><worldbody>";
  write_children(robot, -1, xml);
  return xml + "</worldbody></mujoco>";
}

struct MujocoOracle::State {
  explicit State(const Robot& robot) : bodies(robot.body_count()), n(robot.joint_count()) {
    const std::string xml = mjcf(robot);
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    char error[500] = "";
    if (mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(xml.size())) != 0)
      throw std::runtime_error("MuJoCo: no room for the model");
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    model.reset(mj_loadXML("robot.xml", files.get(), error, sizeof error));
    mj_deleteVFS(files.get());
    if (!model) throw std::runtime_error(error);
    for (int i = 0; i < bodies;
         ++i) {  // undoes balanceinertia, without which MuJoCo refuses some makers' numbers
      Matrix axes;
      const auto I = principal(robot.body(i), axes);
      std::copy(
          I.begin(), I.end(),
          model->body_inertia + 3 * mj_name2id(model.get(), mjOBJ_BODY, ("b" + std::to_string(i)).c_str()));
    }
    data.reset(mj_makeData(model.get()));
    std::vector<bool> is_parent(static_cast<std::size_t>(bodies), false);
    for (int i = 0; i < bodies; ++i) {
      body.push_back(mj_name2id(model.get(), mjOBJ_BODY, ("b" + std::to_string(i)).c_str()));
      if (robot.body(i).parent >= 0) is_parent[static_cast<std::size_t>(robot.body(i).parent)] = true;
      if (robot.body(i).motion != Motion::fixed)
        dof.push_back(
            model->jnt_dofadr[mj_name2id(model.get(), mjOBJ_JOINT, ("j" + std::to_string(i)).c_str())]);
    }
    for (int i = 0; i < bodies; ++i)
      if (!is_parent[static_cast<std::size_t>(i)]) leaves.push_back(body[static_cast<std::size_t>(i)]);
    square.resize(static_cast<std::size_t>(std::max(6, n) * n));
    rows.resize(static_cast<std::size_t>(6 * n));
  }

  int at(int joint) const { return dof[static_cast<std::size_t>(joint)]; }
  void load(double* to, const double* from) const {
    for (int j = 0; j < n; ++j) to[at(j)] = from[j];
  }
  void unload(const double* from, double* to) const {
    for (int j = 0; j < n; ++j) to[j] = from[at(j)];
  }
  void place(const double* q) {
    load(data->qpos, q);
    mj_kinematics(model.get(), data.get());
  }
  void move(const double* q, const double* dq) {
    place(q);
    mj_comPos(model.get(), data.get());
    if (dq != nullptr)
      load(data->qvel, dq);
    else
      std::fill_n(data->qvel, n, 0.0);
    mj_comVel(model.get(), data.get());
  }

  int bodies, n;
  std::unique_ptr<mjModel, FreeModel> model;
  std::unique_ptr<mjData, FreeData> data;
  std::vector<int> body, dof, leaves;
  std::vector<double> square, rows;
};

MujocoOracle::MujocoOracle(const Robot& robot) : state_(std::make_unique<State>(robot)) {}
MujocoOracle::~MujocoOracle() = default;
MujocoOracle::MujocoOracle(MujocoOracle&&) noexcept = default;
MujocoOracle& MujocoOracle::operator=(MujocoOracle&&) noexcept = default;

int MujocoOracle::joint_count() const {
  return state_->n;
}
int MujocoOracle::body_count() const {
  return state_->bodies;
}

void MujocoOracle::pose(int body, const double* q, double* R, double* p) {
  State& s = *state_;
  s.place(q);
  const int b = s.body[static_cast<std::size_t>(body)];
  std::copy_n(s.data->xmat + 9 * b, 9, R);
  std::copy_n(s.data->xpos + 3 * b, 3, p);
}

void MujocoOracle::jacobian(int body, const double* point, const double* q, double* J) {
  State& s = *state_;
  s.place(q);
  mj_comPos(s.model.get(), s.data.get());
  const int b = s.body[static_cast<std::size_t>(body)];
  double x[3];
  mju_rotVecMat(x, point, s.data->xmat + 9 * b);
  mju_addTo3(x, s.data->xpos + 3 * b);
  mj_jac(s.model.get(), s.data.get(), s.rows.data(), s.rows.data() + 3 * s.n, x, b);
  for (int r = 0; r < 6; ++r) s.unload(s.rows.data() + r * s.n, J + r * s.n);
}

void MujocoOracle::inverse_dynamics(const double* q, const double* dq, const double* ddq, double* tau) {
  State& s = *state_;
  s.move(q, dq);
  s.load(s.data->qacc, ddq);
  mj_rne(s.model.get(), s.data.get(), 1, s.data->qfrc_inverse);
  s.unload(s.data->qfrc_inverse, tau);
}

void MujocoOracle::gravity(const double* q, double* G) {
  bias(q, nullptr, G);
}

void MujocoOracle::bias(const double* q, const double* dq, double* result) {
  State& s = *state_;
  s.move(q, dq);
  mj_rne(s.model.get(), s.data.get(), 0, s.data->qfrc_bias);
  s.unload(s.data->qfrc_bias, result);
}

void MujocoOracle::mass_matrix(const double* q, double* M) {
  State& s = *state_;
  s.place(q);
  mj_comPos(s.model.get(), s.data.get());
  mj_crb(s.model.get(), s.data.get());
  mj_fullM(s.model.get(), s.square.data(), s.data->qM);
  for (int r = 0; r < s.n; ++r) s.unload(s.square.data() + s.at(r) * s.n, M + r * s.n);
}

void MujocoOracle::forward_dynamics(const double* q, const double* dq, const double* tau, double* ddq) {
  State& s = *state_;
  s.move(q, dq);
  mj_crb(s.model.get(), s.data.get());
  mj_factorM(s.model.get(), s.data.get());
  mj_rne(s.model.get(), s.data.get(), 0, s.data->qfrc_bias);
  s.load(s.data->qfrc_applied, tau);
  for (int j = 0; j < s.n; ++j) s.data->qfrc_applied[j] -= s.data->qfrc_bias[j];
  mj_solveM(s.model.get(), s.data.get(), s.data->qacc, s.data->qfrc_applied, 1);
  s.unload(s.data->qacc, ddq);
}

void MujocoOracle::mobility(int body, const double* q, double* A) {
  State& s = *state_;
  s.place(q);
  mj_comPos(s.model.get(), s.data.get());
  mj_crb(s.model.get(), s.data.get());
  mj_factorM(s.model.get(), s.data.get());
  double* const J = s.rows.data();
  mj_jacBody(s.model.get(), s.data.get(), J, J + 3 * s.n, s.body[static_cast<std::size_t>(body)]);
  mj_solveM(s.model.get(), s.data.get(), s.square.data(), J, 6);
  mju_mulMatMatT(A, J, s.square.data(), 6, s.n, 6);
}

void MujocoOracle::energy(const double* q, const double* dq, double& potential, double& kinetic) {
  State& s = *state_;
  s.move(q, dq);
  mj_crb(s.model.get(), s.data.get());
  mj_energyPos(s.model.get(), s.data.get());
  mj_energyVel(s.model.get(), s.data.get());
  potential = s.data->energy[0];
  kinetic = s.data->energy[1];
}

void MujocoOracle::peer_poses(const double* q, double* X) {
  State& s = *state_;
  s.place(q);
  for (const int b : s.body) {
    std::copy_n(s.data->xmat + 9 * b, 9, X);
    std::copy_n(s.data->xpos + 3 * b, 3, X + 9);
    X += 12;
  }
}

void MujocoOracle::peer_jacobian(const double* q, double* J) {
  State& s = *state_;
  s.place(q);
  mj_comPos(s.model.get(), s.data.get());
  for (const int b : s.leaves) {
    mj_jacBody(s.model.get(), s.data.get(), J, J + 3 * s.n, b);
    J += 6 * s.n;
  }
}

}  // namespace oracle
