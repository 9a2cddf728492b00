// STATES.csv: one record x,y,vx,vy a disc, records separated by white space.
#pragma once

#include "problem_list.hpp"

#include "ricochet/model.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ricochet::driver {

/// Reads the text of a STATES.csv piece by piece, so that a file need never be in memory.
class StatesParser {
 public:
  /// What is wrong with the file called `name` goes to `problems`; with a `model`, discs that
  /// cannot be simulated in it are wrong too.
  StatesParser(std::string name, std::optional<Model> const& model, ProblemList& problems);

  /// Takes the next piece; pieces may end anywhere.
  void feed(std::string_view piece);

  /// Ends the text and returns the discs in the order of their records.
  std::vector<DiscState> finish();

  std::vector<DiscState>& discs() { return discs_; }

 private:
  // Where a record that is not yet checked against the model stands.
  struct Record {
    std::int64_t line;
    std::int64_t columns[4];
  };

  void parse_word(std::string_view word);
  bool parse_record(std::string_view word, DiscState& disc, Record& record);
  void check_pending();
  void add(Place place, std::string const& problem, std::string const& suggestion = "");

  std::string name_;
  std::optional<Model> model_;
  ProblemList& problems_;
  std::vector<DiscState> discs_;
  std::vector<DiscState> pending_discs_; ///< a small batch on its way to the check
  std::vector<Record> pending_records_;
  std::string carry_; ///< the part of a word that earlier pieces held
  Place carry_place_; ///< where it starts
  Place place_;       ///< of the next character
  int bom_bytes_ = 0; ///< how much of a byte-order mark was seen
  bool at_start_ = true;
  bool skipping_ = false; ///< inside a word that is too long to be a record
};

/// Reads the file `path`. Throws Failure if it cannot be read.
std::vector<DiscState> read_states(std::string const& path, std::optional<Model> const& model,
                                   ProblemList& problems);

} // namespace ricochet::driver
