#pragma once

#include <vector>

#include "client/cli/publish/response/damper.hpp"
#include "tests/studies/response/line.hpp"

namespace collided::response {

/// Forces of the contacts of a line at a moment: k depth + d depth_rate where a gap is at most `touching_m`, never pulling.
void contact_forces(const Line& line, const Spring& spring, const Motion& motion, double touching_m,
                    std::vector<double>& force_n);

/// One implicit stage: finds velocity v and forces f with
///     v = from.velocity + h M^-1 B^T f,   x = from.position + h v,
///     f = max(0, k depth(x) + d (depth(x) - depth(from)) / h),
/// which is implicit Euler with `from` the start (and gravity in its velocity), and each stage of a diagonally implicit method.
/// Always: one solution, found in at most one round a contact, whatever k h^2 / m is. In the forces the stage is the linear
/// complementarity problem of A = 1/s + h^2 B M^-1 B^T, a tridiagonal M-matrix; contacts only ever join the set that
/// pushes, since each that does pushes the others closer.
/// error      of forces entrywise: elimination adds and multiplies numbers of one sign only, so masses 1e6 apart and
///            stiffness without end cost no digits. Velocities are differences of forces: within roundings of force * h / m
/// source     Chandrasekaran, "A special case of the complementary pivot problem", Opsearch 7, 1970; Cottle, Pang, Stone,
///            "The Linear Complementarity Problem", 1992, 4.7; Grassmann, Taksar, Heyman, "Regenerative analysis and steady
///            state distributions", Oper. Res. 33, 1985 (elimination without subtraction)
class ContactSolve {
 public:
  /// Solves for line.size() + 1 contacts; h in (0, inf). `from` becomes the state at the stage's end.
  void stage(const Line& line, const Spring& spring, double h, Motion& from);
  /// Impulses that stop the approach in the contacts of `touching` together, without a bounce: the same problem with s
  /// infinite. Changes velocities.
  void stop(const Line& line, const std::vector<char>& touching, std::vector<double>& velocity_m_s);

  const std::vector<double>& force() const { return force_; }

 private:
  void solve(const Line& line, double h2);
  void solve_run(const Line& line, double h2, std::size_t first, std::size_t last);
  bool admit(const Line& line, double h2);

  std::vector<double> need_;   // how far each contact would be over its limit without forces: -q
  std::vector<double> slack_;  // 1 / s
  std::vector<char> pushing_, may_push_;
  std::vector<double> force_, pivot_, right_;
};

}  // namespace collided::response
