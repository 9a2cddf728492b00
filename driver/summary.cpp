#include "summary.hpp"

#include "provenance.hpp"

#include <fmt/format.h>

namespace ricochet::driver {

double Summary::disc_steps_per_second() const
{
  return static_cast<double>(report.discs) * static_cast<double>(report.steps) / wall_seconds;
}

double Summary::collisions_per_second() const
{
  return static_cast<double>(report.collisions) / wall_seconds;
}

std::string hash_text(std::uint64_t hash)
{
  return fmt::format("{:016x}", hash);
}

std::string in_words(Summary const& summary)
{
  Report const& r = summary.report;
  EnergyLedger const& e = r.energy;
  std::string text =
      fmt::format("ricochet {}: {} discs, {} steps of {} ({}, {}) on {} ({} thread{})\n", version(),
                  r.discs, r.steps, summary.engine, summary.law, summary.precision, summary.backend,
                  summary.threads, summary.threads == 1 ? "" : "s");
  text += fmt::format("  time        {:.6g} simulated in {:.3g} s", r.time, summary.wall_seconds);
  if (r.steps > 0 && summary.wall_seconds > 0)
    text += fmt::format(", {:.3g} disc steps/s", summary.disc_steps_per_second());
  text += fmt::format("\n  collisions  {} pairs ({} of them separating), {} walls\n", r.collisions,
                      r.separating_hits, r.wall_hits);
  ExecutionCounts const& x = r.executions;
  if (x.islands + x.crowd + x.rounds + x.in_order > 0)
    text += fmt::format(
        "  executed    {} steps by islands, {} with a crowd, {} in rounds, {} in order\n",
        x.islands, x.crowd, x.rounds, x.in_order);
  if (r.windows > 0)
    text += fmt::format("  executed    {} windows\n", r.windows);
  text += fmt::format(
      "  energy      {:.10g} at the start, {:.10g} now: lost {:.6g} in pairs, {:.6g} at walls, "
      "numerical {:+.6g}, residual {:+.1e}\n",
      e.initial(), e.kinetic + e.potential, e.lost_pairs, e.lost_walls, e.numerical, e.residual());
  if (summary.is_at_rest)
    text += fmt::format("  rest        {}\n", *summary.is_at_rest
                                                  ? "all discs rest"
                                                  : "some discs still moved at the last look");
  text += fmt::format("  overlap     {:.3g} diameters at most, {:.3g} outside the walls\n",
                      r.max_overlap, r.max_outside);
  text += fmt::format("  state hash  {}\n", hash_text(summary.state_hash));
  for (std::string const& output : summary.outputs)
    text += fmt::format("  wrote       {}\n", output);
  return text;
}

} // namespace ricochet::driver
