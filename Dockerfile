# Sessions without a ROS master: docker build -t e2e_cdiff . && docker run --rm -v "$PWD/results:/results" e2e_cdiff
FROM debian:12 AS build
WORKDIR /e2e_cdiff
COPY . .
RUN scripts/package

FROM debian:12
COPY --from=build /e2e_cdiff/build_package/package/ /packages/
RUN apt-get update && apt-get install --yes --no-install-recommends /packages/e2e-cdiff_*.deb && rm -rf /packages /var/lib/apt/lists/*
WORKDIR /
ENTRYPOINT ["cdiff"]
CMD ["demo"]
