# Truths of Borgonovo's delta: mean total-variation distance between the law of y given x and that of y, by quadrature.
import numpy as np
from scipy.stats import norm
from scipy.special import k0
def tv(f,g,y): return 0.5*np.trapezoid(np.abs(f-g),y)
# product
y=np.concatenate([-np.logspace(2,-9,6000),np.logspace(-9,2,6000)])
fy=k0(np.abs(y))/np.pi
zz=norm.ppf((np.arange(4000)+.5)/4000); zz=zz[zz>0]
print('prod',np.mean([tv(norm.pdf(y,0,a),fy,y) for a in zz]))
# linear a*z0+b*z1
def lin(a,b):
    s=np.hypot(a,b); y=np.linspace(-9*s,9*s,20001); f=norm.pdf(y,0,s); zz=norm.ppf((np.arange(2000)+.5)/2000)
    return np.mean([tv(norm.pdf(y,a*t,b),f,y) for t in zz])
print('logn',lin(1,.5),lin(.5,1),'logn2',lin(1.5,1),lin(1,1.5))
# cubic z0^3+z1
zz=norm.ppf((np.arange(20000)+.5)/20000)
y=np.linspace(-90,90,36001); h=y[1]-y[0]
# density of cube + normal by histogram convolution
cub=np.sort(zz**3)
edges=np.append(y-h/2,y[-1]+h/2)
cdf_c=norm.cdf(np.cbrt(edges)); pc=np.diff(cdf_c)
k=norm.pdf(np.arange(-10,10+h/2,h))*h
fy=np.convolve(pc,k,'same')/h
d0=np.mean([tv(norm.pdf(y,t**3,1),fy,y) for t in norm.ppf((np.arange(1000)+.5)/1000)])
def cubecell(shift): return np.diff(norm.cdf(np.cbrt(edges-shift)))
d1=np.mean([0.5*np.abs(cubecell(t)-fy*h).sum() for t in norm.ppf((np.arange(1000)+.5)/1000)])
print('poly',d0,d1)

# Ishigami by distribution functions on a grid; the values rise to 0.263, 0.4253 and 0.2103 as it is refined.
def ishi(M=1200,GY=1500):
    t=(np.arange(M)+.5)/M*2*np.pi-np.pi
    s=np.sin(t); q=7*np.sin(t)**2; k=1+.1*t**4
    ys=np.linspace(-11.5,18.5,GY+1)
    # law of s*k (x1,x3) and of q
    # cond on x2: Y=q+W; W=s*k.
    W=np.sort(np.outer(s,k).ravel()); 
    FW=lambda y: np.searchsorted(W,y)/W.size
    FY=np.mean([FW(ys-a) for a in q],axis=0)
    d2=np.mean([0.5*np.abs(np.diff(FW(ys-a))-np.diff(FY)).sum() for a in q])
    qs=np.sort(q); Fq=lambda y: (lambda z: np.where(z<=0,0,np.where(z>=1,1,2/np.pi*np.arcsin(np.sqrt(np.clip(z,0,1))))))(y/7)
    def d1():
        tot=0
        for a in s[::4]:
            F=np.mean([Fq(ys-a*b) for b in k[::2]],axis=0); tot+=0.5*np.abs(np.diff(F)-np.diff(FY)).sum()
        return tot/len(s[::4])
    def d3():
        tot=0
        for b in k[::4]:
            F=np.mean([Fq(ys-a*b) for a in s[::2]],axis=0); tot+=0.5*np.abs(np.diff(F)-np.diff(FY)).sum()
        return tot/len(k[::4])
    return d1(),d2,d3()
if __name__=='__main__':
    for M,GY in ((800,600),(1600,1500)): print(M,GY,ishi(M,GY))
