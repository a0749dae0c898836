# What a consumer of the static library rigproof::core links with.
find_dependency(OpenSSL COMPONENTS Crypto)
find_dependency(yaml-cpp)
