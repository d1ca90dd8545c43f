/// The value of an expression of claims.md. Numbers of a campaign are added to
/// nothing but numbers, subtracted, divided, and multiplied by numbers; values
/// of a run are divided. To text, text and numbers are added: "sip-b" + 8.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>

#include "suite/evidence/claim_names.h"
#include "suite/evidence/claim_tokens.h"

namespace physinv {

/// Calls that one expression may make, those of defined functions included.
inline constexpr int kMostCalls = 10'000;

/// Reads tokens from left to right and computes as it reads. Whatever is wrong
/// throws ExpressionError. Tokens, names, locals and calls stay the caller's.
class Expression {
 public:
  /// What parameters of a defined function are.
  using Locals = std::map<std::string, ClaimValue>;

  Expression(const Tokens& tokens,
             const ClaimNames& names,
             const Locals& locals,
             int& calls_left,
             int depth = 0)
      : tokens_(tokens),
        names_(names),
        locals_(locals),
        calls_left_(calls_left),
        depth_(depth) {}

  /// Of what comes next, up to a token that no expression has there.
  ClaimValue sum();
  template <class T>
  T sum_as() {
    const PlacedText::Place place = now().place;
    return as<T>(sum(), place);
  }
  template <class T>
  T as(const ClaimValue& value, const PlacedText::Place& place) const {
    auto converted = claim_value_as<T>(value);
    if (!converted) needed(typeid(T), value, place);
    return std::move(*converted);
  }

  const Token& now() const { return tokens_[next_]; }
  Token take() { return tokens_[next_++]; }
  bool is(std::string_view text) const;
  bool take_if(std::string_view text);
  void expect(std::string_view text);
  void expect_end() const;
  /// What has not been read.
  Tokens rest() const;
  [[noreturn]] void fail(std::string what) const;

 private:
  ClaimValue product();
  ClaimValue factor();
  ClaimList list(std::string_view close);
  ClaimValue value(const Token& name) const;
  ClaimValue call(const Token& name);
  std::optional<ClaimValue> result_of_call(const ClaimNames::Function& f,
                                           const ClaimList& arguments,
                                           const Token& name) const;
  [[noreturn]] void unknown(const Token& name) const;
  [[noreturn]] static void needed(std::type_index type,
                                  const ClaimValue& given,
                                  const PlacedText::Place& place);

  const Tokens& tokens_;
  const ClaimNames& names_;
  const Locals& locals_;
  int& calls_left_;
  int depth_;
  std::size_t next_ = 0;
};

}  // namespace physinv
