#include "states_csv.hpp"

#include "input_file.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace ricochet::driver {

namespace {

constexpr std::size_t longest_record = 4096;
constexpr std::size_t batch = 1024;
constexpr char const* names[4] = {"x", "y", "vx", "vy"};
constexpr char const* no_blanks = "remove the blanks around the commas";
constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

int field_of(std::string const& quantity)
{
  for (int field = 0; field < 4; ++field)
    if (quantity == names[field])
      return field;
  return 0;
}

} // namespace

StatesParser::StatesParser(std::string name, std::optional<Model> const& model,
                           ProblemList& problems)
  : name_(std::move(name)), model_(model), problems_(problems)
{
}

void StatesParser::add(Place place, std::string const& problem, std::string const& suggestion)
{
  check_pending(); // so that problems come in the order of the file
  problems_.add(name_, place, problem, suggestion);
}

void StatesParser::feed(std::string_view piece)
{
  // The mark is three bytes, which may arrive in three pieces.
  while (at_start_ && !piece.empty()) {
    if (piece.front() != byte_order_mark[static_cast<std::size_t>(bom_bytes_)]) {
      carry_.assign(byte_order_mark.substr(0, static_cast<std::size_t>(bom_bytes_)));
      place_.column += bom_bytes_;
      at_start_ = false;
      break;
    }
    piece.remove_prefix(1);
    at_start_ = ++bom_bytes_ < 3;
  }

  std::size_t at = 0;
  while (at < piece.size()) {
    if (carry_.empty() && !skipping_) {
      while (at < piece.size() && is_space(piece[at])) {
        place_ =
            piece[at] == '\n' ? Place{place_.line + 1, 1} : Place{place_.line, place_.column + 1};
        ++at;
      }
      carry_place_ = place_;
    }
    std::size_t const start = at;
    while (at < piece.size() && !is_space(piece[at]))
      ++at;
    place_.column += static_cast<std::int64_t>(at - start);
    std::string_view const word = piece.substr(start, at - start);
    bool const ended = at < piece.size();

    if (skipping_) {
      skipping_ = !ended;
      continue;
    }
    if (carry_.size() + word.size() > longest_record) {
      add(carry_place_,
          fmt::format("found a record of more than {} characters {} (a record is x,y,vx,vy)",
                      longest_record, in_quotes(carry_.empty() ? word : std::string_view(carry_))));
      carry_.clear();
      skipping_ = !ended;
      continue;
    }
    if (!ended) {
      carry_ += word;
    } else if (!carry_.empty()) {
      carry_ += word;
      parse_word(std::exchange(carry_, {}));
    } else if (!word.empty()) {
      parse_word(word);
    }
  }
}

std::vector<DiscState> StatesParser::finish()
{
  if (at_start_ && bom_bytes_ > 0) // an incomplete mark and nothing else
    carry_.assign(byte_order_mark.substr(0, static_cast<std::size_t>(bom_bytes_)));
  if (!carry_.empty())
    parse_word(std::exchange(carry_, {}));
  check_pending();
  return std::move(discs_);
}

void StatesParser::parse_word(std::string_view word)
{
  DiscState disc{};
  Record record{};
  if (!parse_record(word, disc, record))
    return;
  discs_.push_back(disc);
  if (!model_)
    return;
  pending_discs_.push_back(disc);
  pending_records_.push_back(record);
  if (pending_discs_.size() == batch)
    check_pending();
}

bool StatesParser::parse_record(std::string_view word, DiscState& disc, Record& record)
{
  auto const numbers = 1 + std::count(word.begin(), word.end(), ',');
  if (numbers != 4) {
    bool const broken = word.front() == ',' || word.back() == ',';
    add(carry_place_,
        fmt::format("found {} number{} in {} (a record is the four numbers x,y,vx,vy; white space "
                    "separates records)",
                    numbers, numbers == 1 ? "" : "s", in_quotes(word)),
        broken ? no_blanks : "");
    return false;
  }

  bool good = true;
  double* const values[4] = {&disc.x, &disc.y, &disc.vx, &disc.vy};
  record.line = carry_place_.line;
  std::size_t start = 0;
  for (int field = 0; field < 4; ++field) {
    std::size_t const end = std::min(word.find(',', start), word.size());
    std::string_view const number = word.substr(start, end - start);
    record.columns[field] = carry_place_.column + static_cast<std::int64_t>(start);
    NumberError const error = parse_decimal(number, *values[field]);
    if (error != NumberError::none) {
      bool const header = record.line == 1 && number == names[field];
      bool const at_comma = number.empty() && (field == 0 || field == 3);
      add({record.line, record.columns[field]},
          fmt::format("{}: found {}, which {} (allowed: a decimal number)", names[field],
                      in_quotes(number), explain(error)),
          header     ? "remove the header line"
          : at_comma ? no_blanks
                     : "");
      good = false;
    }
    start = end + 1;
  }
  return good;
}

void StatesParser::check_pending()
{
  if (pending_discs_.empty())
    return;
  for (DiscProblem const& wrong : problems(*model_, pending_discs_)) {
    Record const& record = pending_records_[wrong.disc];
    int const field = field_of(wrong.problem.quantity);
    problems_.add(name_, {record.line, record.columns[field]},
                  fmt::format("{}: found {} (allowed: {})", wrong.problem.quantity,
                              wrong.problem.found, wrong.problem.allowed));
  }
  pending_discs_.clear();
  pending_records_.clear();
}

std::vector<DiscState> read_states(std::string const& path, std::optional<Model> const& model,
                                   ProblemList& problems)
{
  InputFile file(path);
  StatesParser parser(path, model, problems);
  std::vector<char> buffer(1 << 20);
  std::size_t total = 0;
  for (;;) {
    std::size_t const got = file.read(buffer.data(), buffer.size());
    parser.feed({buffer.data(), got});
    total += got;
    if (got < buffer.size())
      break;
    if (total == got && !parser.discs().empty()) {
      // Growing by doubling would need three times the memory: guess from the first piece.
      double const bytes_per_disc =
          static_cast<double>(got) / static_cast<double>(parser.discs().size());
      parser.discs().reserve(
          static_cast<std::size_t>(1.02 * static_cast<double>(file.size()) / bytes_per_disc));
    }
  }
  return parser.finish();
}

} // namespace ricochet::driver
