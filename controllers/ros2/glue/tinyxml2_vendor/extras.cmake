find_package(TinyXML2 REQUIRED)
