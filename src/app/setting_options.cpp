#include "app/setting_options.h"

namespace controlspace {

GivenSettings given_settings(const WordsByKey& given) {
    GivenSettings settings;
    for (const auto& [key, words] : given) {
        if (!words.empty()) settings.emplace_back(key, words);
    }
    return settings;
}

std::string type_name(ValueType type, std::size_t at_most) {
    const std::string name = type == ValueType::number         ? "NUMBER"
                             : type == ValueType::whole_number ? "COUNT"
                                                               : "TEXT";
    return at_most == 0   ? name + ",..."
           : at_most == 1 ? name
                          : fmt::format("{} x {}", name, at_most);
}

}  // namespace controlspace
