import numpy as np
class PeriodImages:
    def __init__(self,*a): self.a=a
    def between(self,image,o,s,lags): return np.zeros((36,lags[0]+1,lags[1]+1))
    def moments(self,x): return np.zeros(1)
    def values(self,x): return x
    def fields(self,x): return np.zeros((1,1,1,1))
    nbytes=0
