// What is simulated: the box, the discs, the forces and the contact rule, in plain host types.
//
// Units are the scene's own; any consistent set works. All discs have the same radius and unit
// mass.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace ricochet {

/// What happens at the two ends of an axis of the box.
enum class Boundary { walls, periodic };

/// A rectangle centred on (0, 0): x in [-width/2, width/2], y in [-height/2, height/2].
struct Box {
  double width = 740;  ///< [length], finite, at least 2 radius
  double height = 740; ///< [length], finite, at least 2 radius
  Boundary x = Boundary::walls;
  Boundary y = Boundary::walls; ///< `periodic` only without gravity
};

/// How two touching discs exchange velocity; the formulas are in contact_law.hpp.
enum class Law {
  swap_scale, ///< the original's rule, in the lab frame; conserves momentum only for 1, 1
  restitution ///< relative velocity is damped; conserves momentum
};

/// The contact rule. Walls use the same two coefficients: normal velocity times -restitution,
/// tangential velocity times friction.
struct Contact {
  Law law = Law::swap_scale;
  double restitution = 0.93; ///< elastic coefficient alpha, 0...1; 1 is elastic
  double friction = 0.93;    ///< friction coefficient beta, 0...1; 1 is frictionless
  bool pairs = true;         ///< whether discs meet; if not, they pass through each other
};

/// Everything that determines the motion, apart from the initial state and the method.
struct Model {
  Box box;
  double radius = 3;     ///< [length], > 0
  double gravity = 9.81; ///< [length/time^2], finite; acts along -y, so a negative value lifts
  Contact contact;
};

/// Position and velocity of one disc.
struct DiscState {
  double x, y;   ///< centre [length]
  double vx, vy; ///< [length/time]
};

/// One thing wrong with a model or a state.
struct Problem {
  std::string quantity; ///< by its name in a scene, such as "contact.restitution"
  std::string found;    ///< the offending value
  std::string allowed;  ///< what would have been accepted, and why
};

/// Every problem of a model; empty when it can be simulated.
std::vector<Problem> problems(Model const& model);

/// A disc that cannot be simulated, and why: a number that is not finite, or a centre outside the
/// box.
struct DiscProblem {
  std::size_t disc; ///< index in the list given
  Problem problem;  ///< `quantity` is "x", "y", "vx" or "vy"
};

/// Every problem of the discs of an initial state, in order; empty when the state can be simulated.
std::vector<DiscProblem> problems(Model const& model, std::vector<DiscState> const& discs);

/// Share of the plane that discs can cover at most without overlap, just above pi / sqrt(12).
constexpr double densest_packing = 0.9069;

/// Share of the box covered by `count` discs: count pi radius^2 / (width height).
double packing_fraction(Model const& model, std::size_t count);

/// Collisions of a disc per time, where `count` discs are spread evenly: Enskog's rate with the
/// contact value of Henderson 1975 (doi 10.1080/00268977500102511), good to some percent below
/// packing 0.7,
///   8 packing / (sqrt(pi) diameter) (1 - 7 packing/16) / (1 - packing)^2 sqrt(T),
/// at the temperature T, the variance of a component of velocity. Arithmetic and roots only: the
/// same on every machine.
double collision_rate(Model const& model, std::size_t count, double temperature);

} // namespace ricochet
