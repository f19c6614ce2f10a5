// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <initializer_list>
#include <pugixml.hpp>
#include <string>
#include <utility>

namespace cdiff::exchange {

// Trees of XML elements: what the writers of this layer share.

/// Appends an element with attributes of these values, which are made plain (core::plainText).
pugi::xml_node append(pugi::xml_node parent, const char* name,
                      std::initializer_list<std::pair<const char*, std::string>> attributes = {});

/// Appends an element that holds this text alone.
pugi::xml_node appendText(pugi::xml_node parent, const char* name, const std::string& text);

/// The file's text, with an XML declaration, two spaces a level.
std::string documentText(const pugi::xml_document& document);

}  // namespace cdiff::exchange
